/** Which factor moves an outcome: a tornado, and Sobol indices. */
import { ends, named, said, scale } from "./axes";
import type { SobolOf, TornadoOf } from "./messages";

const [TOP, LOW, ROW] = [22, 40, 34];

/** Room for the names of factors, pixels. */
function leftOf(paths: string[], wide: number): number {
  return Math.min(24 + 7 * Math.max(...paths.map((p) => p.length)), wide * 0.35);
}

export function Tornado({ found, wide, open }: { found: TornadoOf; wide: number; open: (member: number) => void }) {
  const middle = found.middle;
  if (middle === null) return <p class="hint">The run in the middle has no value.</p>;
  const w = Math.min(wide, 820);
  const left = leftOf(found.rows.map((r) => named(r.path, r.unit)), w);
  const [right, high] = [44, TOP + ROW * found.rows.length + LOW];
  const [low, most] = ends([middle, ...found.rows.flatMap((r) => r.outcomes).filter((v): v is number => v !== null)]);
  const room = 0.14 * (most - low);
  const x = scale(low - room, most + room, false, Math.max(2, Math.round((w - left - right) / 100)));
  const px = (v: number) => left + x.part(v) * (w - left - right);
  return (
    <figure class="bars" data-view="tornado">
      <svg width={w} height={high} role="group" aria-label={`How far each factor moves ${found.value} from ${said(middle)} ${found.unit}`}>
        {x.ticks.map((v) => (
          <g>
            <line class="grid" x1={px(v)} x2={px(v)} y1={TOP} y2={high - LOW} />
            <text x={px(v)} y={high - LOW + 15} text-anchor="middle">{said(v)}</text>
          </g>
        ))}
        {found.rows.map((row, k) => (
          <g transform={`translate(0,${TOP + k * ROW})`} data-factor={row.path}>
            <text class="what" x={left - 8} y={ROW / 2 + 4} text-anchor="end">{named(row.path, row.unit)}</text>
            {row.outcomes.map((v, end) => {
              if (v === null) return <text x={px(middle) + 4} y={ROW / 2 + 4}>no value</text>;
              const rightwards = v > middle || (v === middle && end === 1);
              const told = `${row.path} = ${said(row.ends[end])}: ${found.value} = ${said(v)}`;
              const act = () => open(row.members[end]);
              return (
                <g class={"bar " + (end ? "upper" : "lower")} role="button" tabindex={0} aria-label={`${told}. Open this run.`} onClick={act} onKeyDown={(e) => e.key === "Enter" && act()}>
                  <rect x={Math.min(px(v), px(middle))} y={5} width={Math.max(Math.abs(px(v) - px(middle)), 1)} height={ROW - 10} data-outcome={v}>
                    <title>{told}</title>
                  </rect>
                  <text x={px(v) + (rightwards ? 4 : -4)} y={ROW / 2 + 4} text-anchor={rightwards ? "start" : "end"}>{said(row.ends[end])}</text>
                </g>
              );
            })}
          </g>
        ))}
        <line class="middle" x1={px(middle)} x2={px(middle)} y1={TOP - 4} y2={high - LOW} />
        <text x={px(middle)} y={TOP - 9} text-anchor="middle">{said(middle)}</text>
        <text class="what" x={(left + w - right) / 2} y={high - 6} text-anchor="middle">{named(found.value, found.unit)}</text>
      </svg>
      <figcaption>
        <span class="key"><i class="lower" /> lower end of the factor</span>
        <span class="key"><i class="upper" /> upper end</span>
      </figcaption>
    </figure>
  );
}

export function Sobol({ found, wide }: { found: SobolOf; wide: number }) {
  const w = Math.min(wide, 820);
  const left = leftOf(found.rows.map((r) => r.path), w);
  const [right, high] = [64, TOP + ROW * found.rows.length + LOW];
  const values = found.rows.flatMap((r) => [r.first, r.total].flatMap(([v, e]) => (v === null ? [] : [v - (e ?? 0), v + (e ?? 0)])));
  if (!values.length) return <p class="hint">The outcome does not vary.</p>;
  const [low, most] = ends([0, ...values]);
  const x = scale(low, Math.max(most, 0.1) * 1.02, false, Math.max(2, Math.round((w - left - right) / 90)));
  const px = (v: number) => left + x.part(v) * (w - left - right);
  return (
    <figure class="bars" data-view="sobol">
      <svg width={w} height={high} role="img" aria-label={`Parts of the variance of ${found.value}: ${found.rows.map((r) => `${r.path} alone ${said(r.first[0])}, with others ${said(r.total[0])}`).join("; ")}`}>
        {x.ticks.map((v) => (
          <g>
            <line class="grid" x1={px(v)} x2={px(v)} y1={TOP} y2={high - LOW} />
            <text x={px(v)} y={high - LOW + 15} text-anchor="middle">{said(v)}</text>
          </g>
        ))}
        {found.rows.map((row, k) => (
          <g transform={`translate(0,${TOP + k * ROW})`} data-factor={row.path}>
            <text class="what" x={left - 8} y={ROW / 2 + 4} text-anchor="end">{row.path}</text>
            {[row.first, row.total].map(([v, error], j) => {
              if (v === null) return null;
              const y = 5 + j * 13;
              const reach = Math.max(px(v), px(v + (error ?? 0)));
              return (
                <g class={"bar still " + (j ? "upper" : "lower")}>
                  <rect x={Math.min(px(v), px(0))} y={y} width={Math.abs(px(v) - px(0))} height={11} data-index={v} />
                  {error !== null && <path class="whisker" d={`M${px(v - error)},${y + 2}v7m0,-3.5H${px(v + error)}m0,-3.5v7`} />}
                  <text x={reach + 5} y={y + 9}>{said(+v.toFixed(3))}</text>
                </g>
              );
            })}
          </g>
        ))}
        <line class="middle" x1={px(0)} x2={px(0)} y1={TOP - 4} y2={high - LOW} />
        <text class="what" x={(left + w - right) / 2} y={high - 6} text-anchor="middle">part of the variance of {found.value}</text>
      </svg>
      <figcaption>
        <span class="key"><i class="lower" /> alone</span>
        <span class="key"><i class="upper" /> with others</span>
        <small>
          {found.points} points, 95 % intervals{found.leftOut > 0 && `; ${found.leftOut} left out: a run failed`}
        </small>
      </figcaption>
    </figure>
  );
}
