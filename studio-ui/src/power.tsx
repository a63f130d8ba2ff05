/** Who gives power and who takes it at the time cursor, as a Sankey diagram and as a table. */
import { useEffect, useState } from "preact/hooks";
import type { Energies, EnergyShare, GraphNode } from "./messages";
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

/** How long the cursor rests before energies are asked for, ms. */
const PATIENCE = 150;
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

/** One ribbon. */
interface Flow {
  name: string;
  size: number;
  select?: () => void;
}

/** Ribbons from givers over a bar to takers. */
function Sankey({ gives, takes }: { gives: Flow[]; takes: Flow[] }) {
  const sum = (list: Flow[]) => list.reduce((total, s) => total + s.size, 0);
  const total = Math.max(sum(gives), sum(takes)) || 1;
  const many = Math.max(1, gives.length, takes.length);
  const high = many * (ROW + GAP) + 120;
  const scale = (high - many * GAP - 8) / total;
  const side = (list: Flow[], left: boolean) => {
    let y = 4;
    let inner = 4;
    return list.map((s) => {
      const size = s.size * scale;
      const [y0, m0] = [y, inner];
      y += Math.max(size, 1) + GAP;
      inner += size;
      const [edge, middle] = left ? [BAR, WIDE / 2 - BAR / 2] : [WIDE - BAR, WIDE / 2 + BAR / 2];
      const bend = (edge + middle) / 2;
      return (
        <g class={"flow " + (left ? "gives" : "takes")} onClick={s.select}>
          <path d={`M${edge},${y0}C${bend},${y0} ${bend},${m0} ${middle},${m0}V${m0 + size}C${bend},${m0 + size} ${bend},${y0 + size} ${edge},${y0 + size}Z`} />
          <rect x={left ? 0 : WIDE - BAR} y={y0} width={BAR} height={Math.max(size, 1)} />
          <text x={left ? BAR + 4 : WIDE - BAR - 4} y={y0 + Math.max(size, 1) / 2 + 4} text-anchor={left ? "start" : "end"}>{s.name}</text>
        </g>
      );
    });
  };
  return (
    <svg class="sankey" viewBox={`0 0 ${WIDE} ${high}`} role="img" aria-label={`Sankey diagram: ${gives.map((s) => s.name).join(", ")} give, ${takes.map((s) => s.name).join(", ")} take`}>
      {side(gives, true)}
      {side(takes, false)}
      <rect class="middle-bar" x={WIDE / 2 - BAR / 2} y={4} width={BAR} height={total * scale} />
    </svg>
  );
}

export function Power({ store, state }: Props) {
  const [whole, setWhole] = useState(false);
  if (!state.cursor) return <p class="hint">Run the model and choose a time in its plots.</p>;
  return (
    <section class="power-panel">
      <div class="row" role="group" aria-label="What is shown">
        <button aria-pressed={!whole} onClick={() => setWhole(false)}>Power at the cursor</button>
        <button aria-pressed={whole} onClick={() => setWhole(true)}>Energy up to it</button>
      </div>
      {whole ? <Energy store={store} state={state} /> : <Now store={store} state={state} />}
    </section>
  );
}

/** Energies from the start of the run to the cursor, of the whole model, jumps included. */
function Energy({ store, state }: Props) {
  const [found, setFound] = useState<Energies | null>(null);
  const t = state.cursor!.t;
  const run = state.run?.run;
  useEffect(() => {
    let gone = false;
    const timer = setTimeout(() => {
      store.transport
        .ask<Energies>("energies", { run, t })
        .then((a) => !gone && setFound(a))
        .catch((e) => store.refused(e));
    }, PATIENCE);
    return () => {
      gone = true;
      clearTimeout(timer);
    };
  }, [run, t]);
  if (!found) return <p class="hint">…</p>;
  const names = new Set(state.look!.view.nodes.map((n) => n.name));
  const flow = (s: EnergyShare): Flow => ({ name: s.name, size: s.energy, select: names.has(s.name) ? () => store.set({ nodes: new Set([s.name]), bonds: new Set() }) : undefined });
  const sum = (list: EnergyShare[]) => list.reduce((total, s) => total + s.energy, 0);
  return (
    <>
      <h2>
        Energy from {quantity(found.start, "s")} to {quantity(found.end, "s")}
      </h2>
      {found.gives.length + found.takes.length > 0 ? <Sankey gives={found.gives.map(flow)} takes={found.takes.map(flow)} /> : <p class="hint">No energy has flowed.</p>}
      <table>
        <thead>
          <tr><th scope="col">element</th><th scope="col">did</th><th scope="col">energy</th></tr>
        </thead>
        <tbody>
          {[...found.gives.map((s) => [s, "gave"] as const), ...found.takes.map((s) => [s, "took"] as const)].map(([s, did]) => (
            <tr>
              <td>{s.name}</td>
              <td>{did}</td>
              <td class="figure">{quantity(s.energy, "J")}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p class="hint">
        given {quantity(sum(found.gives), "J")}, taken {quantity(sum(found.takes), "J")}
      </p>
    </>
  );
}

function Now({ store, state }: Props) {
  const { found, unknown } = shares(state);
  const most = Math.max(0, ...found.map((s) => Math.abs(s.power)));
  const seen = found.filter((s) => Math.abs(s.power) > 1e-6 * most).sort((a, b) => Math.abs(b.power) - Math.abs(a.power));
  const gives = seen.filter((s) => s.power < 0);
  const takes = seen.filter((s) => s.power > 0);
  const sum = (list: Share[]) => list.reduce((total, s) => total + Math.abs(s.power), 0);
  const select = (node: GraphNode) => store.set({ nodes: new Set([node.name]), bonds: new Set() });
  const flow = (s: Share): Flow => ({ name: s.node.name, size: Math.abs(s.power), select: () => select(s.node) });
  return (
    <>
      <h2>Power at t = {quantity(state.cursor!.t, "s")}</h2>
      {seen.length > 0 ? <Sankey gives={gives.map(flow)} takes={takes.map(flow)} /> : <p class="hint">No power flows.</p>}
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
    </>
  );
}
