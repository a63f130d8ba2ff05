/** One signal over another: a trajectory, its jumps as dotted lines, and where the time cursor is. */
import { useEffect, useState } from "preact/hooks";
import type { Phase } from "./messages";
import { number, quantity } from "./quantities";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

const [WIDE, HIGH] = [420, 300];
const MARGIN = { left: 64, right: 12, top: 10, bottom: 34 };

export function PhasePlane({ store, state }: Props) {
  const [found, setFound] = useState<Phase | null>(null);
  const [x, y] = state.plotted;
  const run = state.run!;
  const [t0, t1] = state.span;
  useEffect(() => {
    if (!x || !y) return;
    let gone = false;
    store.transport
      .ask<Phase>("phase", { run: run.run, names: [x, y], t0, t1 })
      .then((a) => !gone && setFound(a))
      .catch((e) => !gone && store.refused(e));
    return () => {
      gone = true;
    };
  }, [run.run, x, y, t0, t1]);
  if (!x || !y) return <p class="hint">Plot two signals: the second is drawn over the first.</p>;
  if (!found) return null;
  const [a, b, c, d] = found.box;
  const [wide, high] = [b - a || 1, d - c || 1];
  const px = (v: number) => MARGIN.left + ((v - a) / wide) * (WIDE - MARGIN.left - MARGIN.right);
  const py = (v: number) => HIGH - MARGIN.bottom - ((v - c) / high) * (HIGH - MARGIN.top - MARGIN.bottom);
  const at = (xs: number[], ys: number[], k: number) => `${px(xs[k]).toFixed(1)},${py(ys[k]).toFixed(1)}`;
  const last = (list: number[]) => list[list.length - 1];
  const jumps = found.pieces.slice(1).map(([xs, ys], k) => {
    const [us, vs] = found.pieces[k];
    return { x1: px(last(us)), y1: py(last(vs)), x2: px(xs[0]), y2: py(ys[0]) };
  });
  const now = state.cursor?.signals;
  const marked = now && now[x] != null && now[y] != null ? [px(now[x]!), py(now[y]!)] : null;
  return (
    <figure class="phase" aria-label={`${y} over ${x}`}>
      <svg viewBox={`0 0 ${WIDE} ${HIGH}`} role="img" aria-label={`${y} over ${x}, from ${number(a)} to ${number(b)} ${found.units[0]} and from ${number(c)} to ${number(d)} ${found.units[1]}`}>
        <rect class="box" x={MARGIN.left} y={MARGIN.top} width={WIDE - MARGIN.left - MARGIN.right} height={HIGH - MARGIN.top - MARGIN.bottom} />
        {a < 0 && b > 0 && <line class="axis" x1={px(0)} x2={px(0)} y1={MARGIN.top} y2={HIGH - MARGIN.bottom} />}
        {c < 0 && d > 0 && <line class="axis" x1={MARGIN.left} x2={WIDE - MARGIN.right} y1={py(0)} y2={py(0)} />}
        {jumps.map((j) => Math.hypot(j.x2 - j.x1, j.y2 - j.y1) > 1 && <line class="jump" {...j} />)}
        {found.pieces.map(([xs, ys]) => (
          <path class="way" d={`M${xs.map((_, k) => at(xs, ys, k)).join("L")}`} />
        ))}
        {marked && <circle class="now" cx={marked[0]} cy={marked[1]} r={4.5} />}
        <text x={MARGIN.left} y={HIGH - MARGIN.bottom + 14}>{quantity(a, found.units[0])}</text>
        <text x={WIDE - MARGIN.right} y={HIGH - MARGIN.bottom + 14} text-anchor="end">{quantity(b, found.units[0])}</text>
        <text x={(WIDE + MARGIN.left) / 2} y={HIGH - 6} text-anchor="middle" class="what">{x}</text>
        <text x={MARGIN.left - 5} y={HIGH - MARGIN.bottom} text-anchor="end">{quantity(c, found.units[1])}</text>
        <text x={MARGIN.left - 5} y={MARGIN.top + 10} text-anchor="end">{quantity(d, found.units[1])}</text>
        <text transform={`translate(12,${(HIGH - MARGIN.bottom) / 2}) rotate(-90)`} text-anchor="middle" class="what">{y}</text>
      </svg>
    </figure>
  );
}
