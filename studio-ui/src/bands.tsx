/** A curve of many runs: some of them, the median, and bands of quantiles. */
import { ends, named, said, scale } from "./axes";
import type { FamilyOf } from "./messages";
import { quantity } from "./quantities";

interface Props {
  found: FamilyOf;
  wide: number;
  high: number;
  chosen: number | null;
  choose: (member: number) => void;
  open: (member: number) => void;
}

const [LEFT, RIGHT, TOP, LOW] = [66, 14, 10, 38];

type Row = (number | null)[];

export function Bands({ found, wide, high, chosen, choose, open }: Props) {
  const { t, bands, curves } = found;
  const all = [...bands, ...curves].flat().filter((v): v is number => v !== null);
  if (!all.length) return <p class="hint">No run has come so far that it has values.</p>;
  const beside = wide > 620;
  const w = Math.max(wide - (beside ? 230 : 0), 160);
  const [across, up] = [w - LEFT - RIGHT, high - TOP - LOW];
  const [low, most] = ends(all);
  const room = 0.05 * (most - low);
  const x = scale(t[0], t[t.length - 1], false, Math.max(2, Math.round(across / 90)));
  const y = scale(low - room, most + room, false, Math.max(2, Math.round(up / 45)));
  const px = (v: number) => LEFT + x.part(v) * across;
  const py = (v: number) => TOP + (1 - y.part(v)) * up;
  const way = (row: Row) => {
    let [d, pen] = ["", "M"];
    row.forEach((v, k) => {
      if (v === null) pen = "M";
      else [d, pen] = [`${d}${pen}${px(t[k]).toFixed(1)},${py(v).toFixed(1)}`, "L"];
    });
    return d;
  };
  const between = (lower: Row, upper: Row) => {
    let d = "";
    for (let k = 0; k < t.length; k++) {
      if (lower[k] === null || upper[k] === null) continue;
      let end = k;
      while (end + 1 < t.length && lower[end + 1] !== null && upper[end + 1] !== null) end++;
      const there = (row: Row, i: number) => `${px(t[i]).toFixed(1)},${py(row[i]!).toFixed(1)}`;
      const steps = Array.from({ length: end - k + 1 }, (_, i) => k + i);
      d += `M${steps.map((i) => there(upper, i)).join("L")}L${steps.reverse().map((i) => there(lower, i)).join("L")}Z`;
      k = end;
    }
    return d;
  };
  const [b05, b25, median, b75, b95] = bands;
  const place = chosen === null ? -1 : found.members.indexOf(chosen);
  const key = (e: KeyboardEvent) => {
    if (e.key === "Enter" && chosen !== null) return open(chosen);
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[e.key];
    if (!step) return;
    e.preventDefault();
    const next = place < 0 ? 0 : place + step;
    if (found.members[next] !== undefined) choose(found.members[next]);
  };
  return (
    <figure class={"outcomes" + (beside ? " beside" : "")} data-view="family">
      <div class="area" style={`width: ${w}px; height: ${high}px`} tabindex={0} role="group" aria-label={`${found.signal} of many runs over time. Arrows choose a run, Enter opens it.`} onKeyDown={key}>
        <svg width={w} height={high} role="img" aria-label={`${found.signal}: from ${said(low)} to ${said(most)} ${found.unit}; the median ends at ${said(median[median.length - 1])}`}>
          <rect class="box" x={LEFT} y={TOP} width={across} height={up} />
          <path class="band" d={between(b05, b95)} />
          <path class="band inner" d={between(b25, b75)} />
          {curves.map((row, k) =>
            k === place ? null : (
              <path class="one" d={way(row)} onClick={() => (choose(found.members[k]), open(found.members[k]))}>
                <title>run {found.members[k]}</title>
              </path>
            ),
          )}
          <path class="median" d={way(median)} />
          {place >= 0 && <path class="one chosen" d={way(curves[place])} onClick={() => open(chosen!)} />}
          {x.ticks.map((v) => (
            <g>
              <line class="tick" x1={px(v)} x2={px(v)} y1={TOP + up} y2={TOP + up + 4} />
              <text x={px(v)} y={TOP + up + 15} text-anchor="middle">{quantity(v, "s")}</text>
            </g>
          ))}
          {y.ticks.map((v) => (
            <g>
              <line class="tick" x1={LEFT - 4} x2={LEFT} y1={py(v)} y2={py(v)} />
              <text x={LEFT - 7} y={py(v) + 3.5} text-anchor="end">{said(v)}</text>
            </g>
          ))}
          <text class="what" x={LEFT + across / 2} y={high - 6} text-anchor="middle">time</text>
          <text class="what" transform={`translate(12,${TOP + up / 2}) rotate(-90)`} text-anchor="middle">{named(found.signal, found.unit)}</text>
        </svg>
      </div>
      <figcaption>
        <b>{named(found.signal, found.unit)}</b>
        <span class="key"><i class="line median" /> median</span>
        <span class="key"><i class="fill inner" /> 25 to 75 %</span>
        <span class="key"><i class="fill" /> 5 to 95 %</span>
        <span class="key"><i class="line one" /> {found.members.length} of {found.kept} runs</span>
        {found.every > 1 && <small>every {found.every}. of the times is drawn</small>}
        <output>{place >= 0 ? `run ${chosen}` : ""}</output>
      </figcaption>
    </figure>
  );
}
