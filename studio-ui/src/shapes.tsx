/** Nodes and bonds as SVG: drawn again only when what they show has changed. */
import { Component } from "preact";
import type { BondStrokes, GraphBond, GraphNode, NodeState } from "./messages";
import {
  CAP,
  LETTERS,
  PARALLEL,
  bondShape,
  letterBox,
  nodeOf,
  stroke,
  width,
  type BondShape,
  type Box,
  type Point,
  type Segment,
} from "./geometry";

export const CELL: Point = [100, 84];

export function pixels(x: number, y: number): Point {
  return [x * CELL[0], y * CELL[1]];
}

const PORT_PITCH = 18;

/**
 * On which side each port of a part is, one letter a port: that of what it is bonded to.
 *
 * Ports that are not bonded keep to the order in which they are written, left and right in turn.
 */
export function portSides(node: GraphNode, toward: Map<string, Point>): string {
  return (node.ports ?? [])
    .map((port, k) => {
      const [dx, dy] = toward.get(`${node.name}.${port}`) ?? [0, 0];
      if (Math.abs(dx) < 1 && Math.abs(dy) < 1) return k % 2 ? "e" : "w";
      if (Math.abs(dy) > 1.1 * Math.abs(dx)) return dy > 0 ? "s" : "n";
      return dx > 0 ? "e" : "w";
    })
    .join("");
}

/** The frame of a part: half as wide to each side, from `top` to `bottom`, rows of ports around 0. */
export function partFrame(node: GraphNode, ports: string) {
  const names = node.ports ?? [];
  const of = (side: string) => names.filter((_, k) => ports[k] === side);
  const widest = (side: string) => Math.max(0, ...of(side).map((p) => width(p, 9)));
  const level = (side: string) => of(side).reduce((sum, p) => sum + width(p, 9) + 10, 0);
  const rows = Math.max(of("e").length, of("w").length);
  const wide = Math.max(54, Math.min(150, width(node.letters, 10.5) + 16), widest("e") + widest("w") + 26, level("n"), level("s"));
  const first = rows ? (-(rows - 1) * PORT_PITCH) / 2 : 0;
  const title = rows ? first - 15 : 4;
  return {
    half: wide / 2,
    first,
    title,
    top: title - (of("n").length ? 27 : 15),
    bottom: (rows ? -first + 11 : 12) + (of("s").length ? 13 : 0),
  };
}

/** Where the ports of a part are, from its centre. */
export function portPlaces(node: GraphNode, ports: string): Map<string, Point> {
  const { half, first, top, bottom } = partFrame(node, ports);
  const found = new Map<string, Point>();
  const count: Record<string, number> = { e: 0, w: 0, n: 0, s: 0 };
  (node.ports ?? []).forEach((port, k) => {
    const side = ports[k];
    const nth = count[side]++;
    if (side === "e" || side === "w") found.set(port, [side === "e" ? half : -half, first + nth * PORT_PITCH]);
    else {
      const all = [...ports].filter((s) => s === side).length;
      found.set(port, [(2 * half * (nth + 1)) / (all + 1) - half, side === "n" ? top : bottom]);
    }
  });
  return found;
}

export function boxOf(node: GraphNode, controlled: boolean, at: Point, ports = ""): Box {
  if (node.kind === "part") {
    const { half, top, bottom } = partFrame(node, ports);
    return { x0: at[0] - half, y0: at[1] + top, x1: at[0] + half, y1: at[1] + bottom };
  }
  return letterBox(node.letters, controlled, at);
}

/** Where a bond meets a node: its centre and letters, or a port of a part. */
export function joint(node: GraphNode, end: string, controlled: boolean, at: Point, ports = ""): [Point, Box] {
  if (node.kind === "part") {
    const port = end.slice(nodeOf(end).length + 1);
    const off = portPlaces(node, ports).get(port);
    if (off) {
      const p: Point = [at[0] + off[0], at[1] + off[1]];
      return [p, { x0: p[0] - 1, y0: p[1] - 1, x1: p[0] + 1, y1: p[1] + 1 }];
    }
  }
  return [at, boxOf(node, controlled, at, ports)];
}

const line = ([[a, b], [c, d]]: Segment) => ({ x1: a, y1: b, x2: c, y2: d });

interface BondProps {
  bond: GraphBond;
  tail: GraphNode;
  head: GraphNode;
  tx: number;
  ty: number;
  hx: number;
  hy: number;
  tailControlled: boolean;
  headControlled: boolean;
  tailPorts: string;
  headPorts: string;
  shift: number;
  drawn?: BondStrokes;
  selected: boolean;
  effort?: string;
  rate?: string;
  flow: number;
}

/** Where effort (1) and flow (-1) are written: above and below, or left and right of the bond. */
function beside(shape: BondShape, side: 1 | -1) {
  const [mx, my] = middle(shape);
  const level = Math.abs(shape.head[0] - shape.tail[0]) >= Math.abs(shape.head[1] - shape.tail[1]);
  if (level) return { x: mx, y: my + (side > 0 ? -6 : 17), "text-anchor": "middle" as const };
  // not on one height: of upright bonds side by side the flow of one would run into the effort of the next
  const low = side * Math.min(7, Math.abs(shape.head[1] - shape.tail[1]) / 5);
  return { x: mx - 9 * side, y: my + 4 - low, "text-anchor": side > 0 ? ("end" as const) : ("start" as const) };
}

/** Where a bond is drawn: between what it meets at its ends. */
function placed(p: BondProps): BondShape {
  const [a, abox] = joint(p.tail, p.bond.ends[0], p.tailControlled, [p.tx, p.ty], p.tailPorts);
  const [b, bbox] = joint(p.head, p.bond.ends[1], p.headControlled, [p.hx, p.hy], p.headPorts);
  return bondShape(abox, bbox, a, b, p.shift * PARALLEL);
}

function middle(shape: BondShape): Point {
  return [(shape.tail[0] + shape.head[0]) / 2, (shape.tail[1] + shape.head[1]) / 2];
}

function changed(a: object, b: object): boolean {
  for (const key in a)
    if ((a as Record<string, unknown>)[key] !== (b as Record<string, unknown>)[key]) return true;
  return false;
}

export class BondShapeView extends Component<BondProps> {
  shouldComponentUpdate(next: BondProps): boolean {
    return changed(next, this.props);
  }

  render(p: BondProps) {
    const shape = placed(p);
    const s = p.drawn;
    const state = (s?.off ? " off" : "") + (s?.conflict ? " conflict" : "");
    const [mx, my] = middle(shape);
    const late = new Set(s?.late ?? []);
    return (
      <g
        class={"bond" + (p.selected ? " selected" : "") + state}
        data-bond={p.bond.key}
        data-text={p.bond.text}
      >
        <line class="reach" {...line([shape.tail, shape.head])} />
        {p.flow !== 0 && (
          <line
            class="power"
            {...line(p.flow > 0 ? [shape.tail, shape.head] : [shape.head, shape.tail])}
            style={{ strokeWidth: `${2 + 5 * Math.abs(p.flow)}px` }}
          />
        )}
        <line class="line" {...line([shape.tail, shape.head])} />
        <line class="line barb" {...line(shape.barb)} />
        {s?.strokes.map((end) => (
          <line class={"stroke" + (late.has(end) ? " derivative" : "")} data-end={end} {...line(stroke(shape, end))} />
        ))}
        {s?.dashed?.map((end) => (
          <line class={"stroke dynamic" + (late.has(end) ? " derivative" : "")} data-end={end} {...line(stroke(shape, end))} />
        ))}
        {s?.conflict && (
          <path class="cross" d={`M${mx - 4.5},${my - 4.5}l9,9m0,-9l-9,9`} />
        )}
      </g>
    );
  }
}

/** Effort and flow of a bond: above all bonds and nodes, so that nothing is drawn over a number. */
export class BondValues extends Component<BondProps> {
  shouldComponentUpdate(next: BondProps): boolean {
    return changed(next, this.props);
  }

  render(p: BondProps) {
    const shape = placed(p);
    return (
      <g data-values={p.bond.key}>
        <text class="value" {...beside(shape, 1)}>
          {p.effort}
        </text>
        <text class="value" {...beside(shape, -1)}>
          {p.rate}
        </text>
      </g>
    );
  }
}

interface NodeProps {
  node: GraphNode;
  x: number;
  y: number;
  state?: NodeState;
  selected: boolean;
  target: boolean;
  taken: string;
  ports: string;
}

function portWords(side: string, x: number, y: number) {
  if (side === "n") return { x, y: y + 13, "text-anchor": "middle" as const };
  if (side === "s") return { x, y: y - 6, "text-anchor": "middle" as const };
  return { x: side === "w" ? x + 6 : x - 6, y: y + 3, "text-anchor": side === "w" ? ("start" as const) : ("end" as const) };
}

/** Where the small text of a node goes: a side where no bond leaves, else a corner. */
function labelPlace(p: NodeProps, box: Box, lines: number) {
  const junction = p.node.kind === "0" || p.node.kind === "1";
  const taken = new Set(p.taken);
  const order = junction ? "nsew" : p.taken === "s" ? "nsew" : "snew";
  const side = [...order].find((s) => !taken.has(s));
  const high = lines * 13;
  const cx = (box.x0 + box.x1) / 2 - p.x;
  if (p.node.kind === "part" && p.ports.includes("s"))
    return p.ports.includes("n")
      ? { x: cx + 8, y: box.y1 - p.y + 13, anchor: "start" }
      : { x: cx, y: box.y0 - p.y - 4 - high + 13, anchor: "middle" };
  if (p.node.kind === "part") return { x: cx, y: box.y1 - p.y + 13, anchor: "middle" };
  if (side === "s") return { x: cx, y: box.y1 - p.y + 13, anchor: "middle" };
  if (side === "n") return { x: cx, y: box.y0 - p.y - 4 - high + 13, anchor: "middle" };
  if (side === "e") return { x: box.x1 - p.x + 4, y: 4 - high / 2 + 8, anchor: "start" };
  if (side === "w") return { x: box.x0 - p.x - 4, y: 4 - high / 2 + 8, anchor: "end" };
  return { x: 10, y: -10 - high + 13, anchor: "start" };
}

export class NodeShape extends Component<NodeProps> {
  shouldComponentUpdate(next: NodeProps): boolean {
    return changed(next, this.props);
  }

  render(p: NodeProps) {
    const { node, state } = p;
    const controlled = state?.controlled ?? (!!node.machine || !!node.law);
    const box = boxOf(node, controlled, [p.x, p.y], p.ports);
    const classes =
      "node" +
      (node.kind === "0" || node.kind === "1" ? " junction" : "") +
      (node.kind === "part" ? " part" : "") +
      (state?.off ? " off" : "") +
      (state?.derivative ? " derivative" : "") +
      (p.selected ? " selected" : "") +
      (p.target ? " target" : "");
    const says = state?.says ?? node.says;
    const words = [
      { role: "name", text: node.name },
      ...(says ? [{ role: "parameter", text: says }] : []),
      ...(node.machine ? [{ role: "machine", text: `[${node.machine}]` }] : []),
      ...(node.law ? [{ role: "law", text: node.law }] : []),
      ...(node.outside ? [{ role: "machine", text: `port ${node.outside.join(", ")}` }] : []),
    ];
    const at = labelPlace(p, box, words.length);
    const baseline = (CAP * LETTERS) / 2;
    const frame = partFrame(node, p.ports);
    return (
      <g class={classes} data-node={node.name} transform={`translate(${p.x},${p.y})`}>
        {node.kind === "part" ? (
          <>
            <rect class="frame" x={-frame.half} y={frame.top} width={2 * frame.half} height={frame.bottom - frame.top} rx={6} />
            <text class="title" y={frame.title} text-anchor="middle">
              {node.letters}
            </text>
            {[...portPlaces(node, p.ports)].map(([port, [x, y]], k) => (
              <g class="port" data-port={`${node.name}.${port}`}>
                <circle class="hit" cx={x} cy={y} r={9} />
                <circle cx={x} cy={y} r={3} />
                <text {...portWords(p.ports[k], x, y)}>
                  {port}
                </text>
              </g>
            ))}
          </>
        ) : (
          <>
            <rect
              class="reach"
              x={box.x0 - p.x - 6}
              y={box.y0 - p.y - 6}
              width={box.x1 - box.x0 + 12}
              height={box.y1 - box.y0 + 12}
            />
            {controlled && (
              <rect
                class="switch"
                x={box.x0 - p.x}
                y={box.y0 - p.y}
                width={box.x1 - box.x0}
                height={box.y1 - box.y0}
                rx={6}
              />
            )}
            <text class="letters" x={controlled ? -4 : 0} y={baseline} text-anchor="middle">
              {node.letters}
            </text>
            {controlled && (
              <text class="subscript" x={width(node.letters, LETTERS, true) / 2 - 3.5} y={baseline + 3.5}>
                c
              </text>
            )}
          </>
        )}
        {words.map((word, k) => (
          <text
            class={word.role}
            x={at.x}
            y={at.y + 13 * k}
            text-anchor={at.anchor}
          >
            {word.text.length > 24 ? word.text.slice(0, 23) + "…" : word.text}
          </text>
        ))}
        {p.selected && (
          <g class="handle" data-handle={node.name}>
            <circle class="hit" cx={box.x1 - p.x + 12} cy={box.y0 - p.y - 8} r={14} />
            <circle cx={box.x1 - p.x + 12} cy={box.y0 - p.y - 8} r={6} />
            <path d={`M${box.x1 - p.x + 9},${box.y0 - p.y - 5}l6,-6m-4,0h4v4`} />
          </g>
        )}
      </g>
    );
  }
}
