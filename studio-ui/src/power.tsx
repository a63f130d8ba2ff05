/** Who gives power and who takes it at the time cursor, as a Sankey diagram and as a table. */
import type { GraphNode } from "./messages";
import { quantity } from "./quantities";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

interface Share {
  node: GraphNode;
  /** Power into the element, W. */
  power: number;
}

const DOES: Record<string, [string, string]> = {
  C: ["gives back", "stores"],
  I: ["gives back", "stores"],
  R: ["gives", "dissipates"],
  G: ["gives", "dissipates"],
  Se: ["supplies", "absorbs"],
  Sf: ["supplies", "absorbs"],
};

const [WIDE, ROW, GAP, BAR] = [310, 17, 7, 10];

/** Power into each element of the level, from efforts and flows of its bonds. */
export function shares(state: State): { found: Share[]; unknown: string[] } {
  const values = state.cursor?.values ?? {};
  const { nodes, bonds } = state.look!.view;
  const into = new Map<string, number | null>();
  for (const b of bonds) {
    const v = values[b.key];
    if (!v || v.power === false) continue;
    const p = v.e === null || v.f === null ? null : v.e * v.f;
    for (const [end, sign] of [[b.tail, -1], [b.head, 1]] as const) {
      const old = into.get(end) === undefined ? 0 : into.get(end)!;
      into.set(end, p === null || old === null ? null : old + sign * p);
    }
  }
  const outer = nodes.filter((n) => n.kind !== "0" && n.kind !== "1" && n.kind !== "TF" && n.kind !== "GY" && into.has(n.name));
  return {
    found: outer.filter((n) => into.get(n.name) !== null).map((node) => ({ node, power: into.get(node.name)! })),
    unknown: outer.filter((n) => into.get(n.name) === null).map((n) => n.name),
  };
}

export function Power({ store, state }: Props) {
  if (!state.cursor) return <p class="hint">Run the model and choose a time in its plots.</p>;
  const { found, unknown } = shares(state);
  const most = Math.max(0, ...found.map((s) => Math.abs(s.power)));
  const seen = found.filter((s) => Math.abs(s.power) > 1e-6 * most).sort((a, b) => Math.abs(b.power) - Math.abs(a.power));
  const gives = seen.filter((s) => s.power < 0);
  const takes = seen.filter((s) => s.power > 0);
  const sum = (list: Share[]) => list.reduce((total, s) => total + Math.abs(s.power), 0);
  const total = Math.max(sum(gives), sum(takes)) || 1;
  const high = Math.max(1, gives.length, takes.length) * (ROW + GAP) + 120;
  const scale = (high - Math.max(gives.length, takes.length) * GAP - 8) / total;
  const select = (node: GraphNode) => store.set({ nodes: new Set([node.name]), bonds: new Set() });
  const side = (list: Share[], left: boolean) => {
    let y = 4;
    let inner = 4;
    return list.map((s) => {
      const size = Math.abs(s.power) * scale;
      const [y0, m0] = [y, inner];
      y += Math.max(size, 1) + GAP;
      inner += size;
      const [edge, middle] = left ? [BAR, WIDE / 2 - BAR / 2] : [WIDE - BAR, WIDE / 2 + BAR / 2];
      const bend = (edge + middle) / 2;
      return (
        <g class={"flow " + (left ? "gives" : "takes")} onClick={() => select(s.node)}>
          <path d={`M${edge},${y0}C${bend},${y0} ${bend},${m0} ${middle},${m0}V${m0 + size}C${bend},${m0 + size} ${bend},${y0 + size} ${edge},${y0 + size}Z`} />
          <rect x={left ? 0 : WIDE - BAR} y={y0} width={BAR} height={Math.max(size, 1)} />
          <text x={left ? BAR + 4 : WIDE - BAR - 4} y={y0 + Math.max(size, 1) / 2 + 4} text-anchor={left ? "start" : "end"}>{s.node.name}</text>
        </g>
      );
    });
  };
  return (
    <section class="power-panel">
      <h2>Power at t = {quantity(state.cursor.t, "s")}</h2>
      {seen.length > 0 ? (
        <svg class="sankey" viewBox={`0 0 ${WIDE} ${high}`} role="img" aria-label={`Sankey diagram: ${gives.map((s) => s.node.name).join(", ")} give, ${takes.map((s) => s.node.name).join(", ")} take`}>
          {side(gives, true)}
          {side(takes, false)}
          <rect class="middle-bar" x={WIDE / 2 - BAR / 2} y={4} width={BAR} height={total * scale} />
        </svg>
      ) : (
        <p class="hint">No power flows.</p>
      )}
      <table>
        <thead>
          <tr><th scope="col">element</th><th scope="col">does</th><th scope="col">power</th></tr>
        </thead>
        <tbody>
          {seen.map((s) => (
            <tr class={state.nodes.has(s.node.name) ? "chosen" : ""}>
              <td><button class="link" onClick={() => select(s.node)}>{s.node.name}</button></td>
              <td>{(DOES[s.node.kind] ?? ["gives", "takes"])[s.power > 0 ? 1 : 0]}</td>
              <td class="figure">{quantity(Math.abs(s.power), "W")}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {unknown.length > 0 && <p class="hint">not determined: {unknown.join(", ")}</p>}
      <p class="hint">
        supplied and given back {quantity(sum(gives), "W")}, taken {quantity(sum(takes), "W")}
      </p>
    </section>
  );
}
