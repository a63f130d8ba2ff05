/** What lies over the canvas: the instant that is shown, the minimap; and which node is the next. */
import type { Sight } from "./sight";
import type { Point } from "./geometry";
import type { GraphNode } from "./messages";
import { CELL } from "./shapes";
import { quantity } from "./quantities";
import type { State, Store } from "./store";

/** Which mode of which instant the canvas shows, and the way to the next. */
export function InstantShown({ store, state }: { store: Store; state: State }) {
  const { event, step } = state.instant!;
  const shown = event.steps[step];
  const values = step < event.steps.length - 1 ? "values before" : "values after";
  return (
    <div class={"wiretext instant " + shown.kind} role="status">
      <button aria-label="Mode before" disabled={step === 0} onClick={() => store.showInstant(event, step - 1)}>◂</button>
      t = {quantity(event.t, "s")}, mode {step + 1} of {event.steps.length}: <b>{shown.kind}</b> <small>({values})</small>
      <button aria-label="Mode after" disabled={step + 1 === event.steps.length} onClick={() => store.showInstant(event, step + 1)}>▸</button>
    </div>
  );
}

/** The nearest node in a direction, those straight ahead first. */
export function nearest(nodes: GraphNode[], from: GraphNode, [dx, dy]: Point): GraphNode | undefined {
  let best: GraphNode | undefined;
  let least = Infinity;
  for (const n of nodes) {
    const along = (n.x - from.x) * dx + (n.y - from.y) * dy;
    const aside = Math.abs((n.x - from.x) * dy - (n.y - from.y) * dx);
    if (along <= 0.01) continue;
    const cost = along + 2.5 * aside;
    if (cost < least) [best, least] = [n, cost];
  }
  return best;
}

/** All of a large graph, and what of it is in sight. */
export function Minimap({ state, sight, size }: { state: State; sight: Sight; size: Point }) {
  const nodes = state.look!.view.nodes;
  if (nodes.length < 25) return null;
  const xs = nodes.map((n) => n.x);
  const ys = nodes.map((n) => n.y);
  const [x0, y0] = [Math.min(...xs) - 1, Math.min(...ys) - 1];
  const [w, h] = [Math.max(...xs) + 2 - x0, Math.max(...ys) + 2 - y0];
  const seen = { x: -sight.x / sight.k / CELL[0], y: -sight.y / sight.k / CELL[1] };
  return (
    <svg class="minimap" viewBox={`${x0} ${y0} ${w} ${h}`} aria-hidden="true">
      {nodes.map((n) => (
        <circle cx={n.x} cy={n.y} r={w / 90} />
      ))}
      <rect x={seen.x} y={seen.y} width={size[0] / sight.k / CELL[0]} height={size[1] / sight.k / CELL[1]} />
    </svg>
  );
}
