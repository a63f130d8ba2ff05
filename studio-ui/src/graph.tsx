/** The picture of a bond graph: signals, bonds, nodes, and the gesture that goes on. */
import { bondShape, nodeOf, sides, type Point } from "./geometry";
import type { GraphBond, GraphNode, Strokes } from "./messages";
import { quantity } from "./quantities";
import { BondShapeView, BondValues, CELL, NodeShape, boxOf, joint, pixels, portSides } from "./shapes";
import type { Sight } from "./sight";
import type { State } from "./store";

export type Gesture =
  | { kind: "press"; node: string; start: Point; at: Point; id: number; add: boolean }
  | { kind: "drag"; names: string[]; start: Point; id: number }
  | { kind: "pan"; last: Point; id: number; moved: boolean }
  | { kind: "box"; start: Point; now: Point; id: number; add: boolean }
  | { kind: "wire"; from: string; start: Point; now: Point; target: string; id: number }
  | { kind: "pinch"; ids: [number, number]; last: [Point, Point] };

/** Which ends bonds have in common, ranges of arrays left out: these are drawn side by side. */
const pairOf = (ends: string[]) => ends.map((e) => e.replace(/\[[^\]]*\]/g, "")).sort().join("|");

interface Props {
  state: State;
  sight: Sight;
  gesture: Gesture | null;
  /** How far what is dragged has come, in the graph. */
  moved: Point;
}

export function GraphPicture({ state, sight, gesture, moved }: Props) {
  const look = state.look!;
  const drawn: Strokes = state.cursor?.strokes ?? look.strokes;
  const dragged = gesture?.kind === "drag" ? new Set(gesture.names) : null;
  const at = new Map<string, Point>();
  const by = new Map<string, GraphNode>();
  for (const n of look.view.nodes) {
    const [x, y] = pixels(n.x, n.y);
    at.set(n.name, dragged?.has(n.name) ? [x + moved[0], y + moved[1]] : [x, y]);
    by.set(n.name, n);
  }
  const controlled = (n: GraphNode) => drawn.nodes[n.name]?.controlled ?? (!!n.machine || !!n.law);
  const around = new Map<string, Point[]>();
  const pairs = new Map<string, string[]>();
  for (const b of look.view.bonds) {
    if (!around.has(b.tail)) around.set(b.tail, []);
    if (!around.has(b.head)) around.set(b.head, []);
    around.get(b.tail)!.push(at.get(b.head)!);
    around.get(b.head)!.push(at.get(b.tail)!);
    const pair = pairOf(b.ends);
    pairs.set(pair, [...(pairs.get(pair) ?? []), b.key]);
  }
  const toward = new Map<string, Point>();
  for (const b of look.view.bonds)
    for (const [end, own, other] of [[b.ends[0], b.tail, b.head], [b.ends[1], b.head, b.tail]])
    {
      const [x, y] = toward.get(end) ?? [0, 0];
      const [p, q] = [at.get(own)!, at.get(other)!];
      toward.set(end, [x + q[0] - p[0], y + q[1] - p[1]]);
    }
  const ports = new Map<string, string>();
  for (const n of look.view.nodes) if (n.kind === "part") ports.set(n.name, portSides(n, toward));
  const portsOf = (name: string) => ports.get(name) ?? "";
  const values = state.cursor?.values;
  const most = values
    ? Math.max(1e-300, ...Object.values(values).map((v) => Math.abs((v.e ?? 0) * (v.f ?? 0))))
    : 1;
  const target = gesture?.kind === "wire" ? nodeOf(gesture.target) : "";
  const bondProps = (b: GraphBond) => {
    const [tail, head] = [by.get(b.tail)!, by.get(b.head)!];
    const [t, h] = [at.get(b.tail)!, at.get(b.head)!];
    const same = pairs.get(pairOf(b.ends))!;
    const value = values?.[b.key];
    return {
      bond: b,
      tail,
      head,
      tx: t[0],
      ty: t[1],
      hx: h[0],
      hy: h[1],
      tailControlled: controlled(tail),
      headControlled: controlled(head),
      tailPorts: portsOf(b.tail),
      headPorts: portsOf(b.head),
      shift: same.indexOf(b.key) - (same.length - 1) / 2,
      drawn: drawn.bonds[b.key] ?? drawn.bonds[`${b.ends[0]} -> ${b.ends[1]}`],
      selected: state.bonds.has(b.key),
      flow: state.flowing && value ? ((value.e ?? 0) * (value.f ?? 0)) / most : 0,
    };
  };
  return (
    <>
      <defs>
        <pattern id="dots" width={CELL[0] / 4} height={CELL[1] / 4} patternUnits="userSpaceOnUse" patternTransform={`translate(${sight.x},${sight.y}) scale(${sight.k})`}>
          <circle cx={0} cy={0} r={0.7} class="dot" />
        </pattern>
        <marker id="signal" viewBox="0 0 8 8" refX={7} refY={4} markerWidth={7} markerHeight={7} orient="auto">
          <path d="M0,1L8,4L0,7z" class="signalhead" />
        </marker>
      </defs>
      {sight.k > 0.45 && <rect class="paper" width="100%" height="100%" fill="url(#dots)" />}
      <g transform={`translate(${sight.x},${sight.y}) scale(${sight.k})`}>
        {look.view.modulations.map((m) => {
          const a = by.get(m.from)!;
          const b = by.get(m.to)!;
          if (!a || !b) return null;
          const [p, q] = [at.get(m.from)!, at.get(m.to)!];
          const s = bondShape(boxOf(a, controlled(a), p, portsOf(a.name)), boxOf(b, controlled(b), q, portsOf(b.name)), p, q, 7);
          return (
            <line class="signal" x1={s.tail[0]} y1={s.tail[1]} x2={s.head[0]} y2={s.head[1]} marker-end="url(#signal)" />
          );
        })}
        {/* each kind in a group of its own: a browser lays out all that a changed group holds */}
        <g>{look.view.bonds.map((b) => <BondShapeView key={b.key} {...bondProps(b)} />)}</g>
        <g>{look.view.nodes.map((n) => (
          <NodeShape
            key={n.name}
            node={n}
            x={at.get(n.name)![0]}
            y={at.get(n.name)![1]}
            state={drawn.nodes[n.name]}
            selected={state.nodes.has(n.name)}
            ports={portsOf(n.name)}
            target={target === n.name || state.bondFrom === n.name}
            taken={[...sides(at.get(n.name)!, around.get(n.name) ?? [])].sort().join("")}
          />
        ))}</g>
        {values && sight.k > 0.6 && (
          <g>{look.view.bonds.map((b) => {
            const value = values[b.key];
            return value && (
              <BondValues key={b.key} {...bondProps(b)} effort={quantity(value.e, value.units[0])} rate={quantity(value.f, value.units[1])} />
            );
          })}</g>
        )}
        {gesture?.kind === "wire" && (
          <Wire from={centreOf(gesture.from, by, at, ports)} to={gesture.now} />
        )}
        {gesture?.kind === "box" && (
          <rect
            class="marquee"
            x={Math.min(gesture.start[0], gesture.now[0])}
            y={Math.min(gesture.start[1], gesture.now[1])}
            width={Math.abs(gesture.now[0] - gesture.start[0])}
            height={Math.abs(gesture.now[1] - gesture.start[1])}
          />
        )}
      </g>
    </>
  );
}

function centreOf(end: string, by: Map<string, GraphNode>, at: Map<string, Point>, ports: Map<string, string>): Point {
  const name = nodeOf(end);
  return joint(by.get(name)!, end, false, at.get(name)!, ports.get(name))[0];
}

function Wire({ from, to }: { from: Point; to: Point }) {
  return <line class="wire" x1={from[0]} y1={from[1]} x2={to[0]} y2={to[1]} />;
}
