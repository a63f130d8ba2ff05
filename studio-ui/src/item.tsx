/** What is selected, to be edited: an element, a part, a junction, a bond, or the model. */
import { Field, valueOf } from "./fields";
import type { GraphNode } from "./messages";
import { quantity } from "./quantities";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

const STARTS: Record<string, string[]> = { C: ["q", "e"], I: ["p", "f"] };
const LAW_FIELDS: Record<string, string[]> = {
  diode: [],
  thyristor: ["gate"],
  unilateral: ["gap", "restitution", "stiffness"],
  coulomb: ["limit", "breakaway"],
  relay: ["limit"],
};

export function Item({ store, state }: Props) {
  const look = state.look!;
  const chosen = look.view.nodes.filter((n) => state.nodes.has(n.name));
  const bonds = look.view.bonds.filter((b) => state.bonds.has(b.key));
  if (chosen.length === 1) return <Node store={store} state={state} node={chosen[0]} />;
  if (bonds.length === 1 && !chosen.length) {
    const b = bonds[0];
    const value = state.cursor?.values[b.key];
    return (
      <section>
        <h2>Bond</h2>
        <label>
          <span>written</span>
          <Field label="Bond" first value={b.text} disabled={!look.view.editable} onWrite={(text) => void rewrite(store, state, b.key, text)} />
        </label>
        {value && (
          <p>
            effort {quantity(value.e, value.units[0])}, flow {quantity(value.f, value.units[1])}, power{" "}
            {value.e === null || value.f === null ? "—" : quantity(value.e * value.f, "W")}
          </p>
        )}
        <div class="row">
          <button onClick={() => store.reverse()}>Turn round (r)</button>
          <button onClick={() => store.remove()}>Delete</button>
        </div>
      </section>
    );
  }
  if (chosen.length + bonds.length > 1)
    return (
      <section>
        <h2>
          {chosen.length} elements, {bonds.length} bonds
        </h2>
        <div class="row">
          <button onClick={() => align(store, chosen, "y")}>In a row</button>
          <button onClick={() => align(store, chosen, "x")}>In a column</button>
          <button disabled={chosen.length < 3} onClick={() => spread(store, chosen, "x")}>Evenly across</button>
          <button disabled={chosen.length < 3} onClick={() => spread(store, chosen, "y")}>Evenly down</button>
          <button onClick={() => void store.duplicate()}>Duplicate</button>
          <button onClick={() => store.remove()}>Delete</button>
        </div>
      </section>
    );
  return <Whole store={store} state={state} />;
}

async function rewrite(store: Store, state: State, key: string, text: string): Promise<void> {
  const [chain] = key.split(".").map(Number);
  const look = state.look!;
  const single = look.view.bonds.filter((b) => b.key.startsWith(`${chain}.`)).length === 1;
  if (single) await store.edit({ do: "write bond", chain, text });
  else {
    await store.edit({ do: "remove", names: [], bonds: [key] });
    if (text.trim()) await store.edit({ do: "write bond", text });
  }
}

function align(store: Store, nodes: GraphNode[], axis: "x" | "y"): void {
  const mean = nodes.reduce((sum, n) => sum + n[axis], 0) / nodes.length;
  const line = Math.round(mean * 4) / 4;
  const at = Object.fromEntries(
    nodes.map((n) => [n.name, axis === "y" ? [n.x, line] : [line, n.y]]),
  );
  void store.edit({ do: "move", at });
}

/** Put elements at equal distances between the first and the last of them. */
function spread(store: Store, nodes: GraphNode[], axis: "x" | "y"): void {
  const order = [...nodes].sort((a, b) => a[axis] - b[axis]);
  const [first, last] = [order[0][axis], order[order.length - 1][axis]];
  const at = Object.fromEntries(
    order.map((n, k) => {
      const place = first + ((last - first) * k) / (order.length - 1);
      return [n.name, axis === "x" ? [place, n.y] : [n.x, place]];
    }),
  );
  void store.edit({ do: "move", at });
}

function Whole({ store, state }: Props) {
  const look = state.look!;
  const domains = state.stock?.domains ?? [];
  const set = (path: string[], value: unknown) => void store.edit({ do: "set", path, value });
  return (
    <section>
      <h2>Model</h2>
      <label>
        <span>title</span>
        <Field label="Title" first value={look.title} disabled={!look.view.editable} onWrite={(t) => set(["title"], t)} />
      </label>
      <label>
        <span>domain</span>
        <select disabled={!look.view.editable} value={look.view.domain} onChange={(e) => set(["domain"], e.currentTarget.value)}>
          {domains.map((d) => (
            <option value={d.name}>
              {d.name} {d.effort && `(${d.effort}, ${d.flow})`}
            </option>
          ))}
        </select>
      </label>
      <p class="hint">
        Put elements down from the palette, or press <kbd>a</kbd> and write <code>R load 10 ohm</code>. Drag from the
        handle of a selected element to bond it, or press <kbd>b</kbd>. Strokes follow each edit. <kbd>/</kbd> finds a name.
      </p>
    </section>
  );
}

function Node({ store, state, node }: Props & { node: GraphNode }) {
  const look = state.look!;
  const off = !look.view.editable;
  const entry = node.entry;
  const set = (key: string[], value: unknown) => void store.edit({ do: "set", path: ["elements", node.name, ...key], value });
  const rename = (text: string) =>
    void store.edit({ do: "rename", old: node.name, new: text.trim() }).then((l) => l && store.set({ nodes: new Set([text.trim()]) }));
  const junction = node.kind === "0" || node.kind === "1";
  const offers = state.stock?.parts.find((p) => p.name === entry.submodel);
  return (
    <section>
      <h2>
        {node.kind === "part" ? String(entry.submodel) : state.stock?.kinds.find((k) => k.kind === node.kind)?.about ?? node.kind}
      </h2>
      <label>
        <span>name</span>
        <Field label="Name" first={junction || node.kind === "part"} value={node.name} disabled={off} onWrite={rename} />
      </label>
      {!junction && node.kind !== "part" && <Law node={node} off={off} set={set} />}
      {STARTS[node.kind]?.map((v) => (
        <label>
          <span>start {v}</span>
          <Field label={`Start value ${v}`} value={text(entry[v])} disabled={off} placeholder="0" onWrite={(t) => set([v], valueOf(t))} />
        </label>
      ))}
      {junction && (
        <>
          <label>
            <span>kind</span>
            <select disabled={off} value={node.kind} onChange={(e) => set(["junction"], Number(e.currentTarget.value))}>
              <option value="0">0, common effort</option>
              <option value="1">1, common flow</option>
            </select>
          </label>
          <label>
            <span>law</span>
            <select disabled={off} value={text(entry.law)} onChange={(e) => set(["law"], e.currentTarget.value || null)}>
              <option value="">none</option>
              {state.stock?.laws.map((l) => <option value={l}>{l}</option>)}
            </select>
          </label>
          {(LAW_FIELDS[text(entry.law)] ?? []).map((key) => (
            <label>
              <span>{key}</span>
              <Field label={key} value={text(entry[key])} disabled={off} onWrite={(t) => set([key], valueOf(t))} />
            </label>
          ))}
          <Switching store={store} state={state} node={node} />
        </>
      )}
      {node.kind === "part" && (
        <>
          {offers && <p class="hint">{offers.title}</p>}
          {Object.entries({ ...offers?.parameters, ...(entry.parameters as object) }).map(([key]) => {
            const given = (entry.parameters as Record<string, unknown>)?.[key];
            return (
              <label>
                <span>{key}</span>
                <Field label={key} value={text(given)} disabled={off} placeholder={offers?.parameters[key]} onWrite={(t) => set(["parameters", key], valueOf(t))} />
              </label>
            );
          })}
          {node.inputs?.map((key) => (
            <label>
              <span>{key} ⟵</span>
              <Field label={`Input ${key}`} value={text((entry.inputs as Record<string, unknown>)?.[key])} disabled={off} placeholder="an expression" list={words(state)} onWrite={(t) => set(["inputs", key], valueOf(t))} />
            </label>
          ))}
          {node.known && <button onClick={() => store.open(state.level ? `${state.level}.${node.name}` : node.name)}>Open</button>}
        </>
      )}
      <div class="row">
        <button disabled={off} onClick={() => store.set({ bondFrom: node.name })}>Bond (b)</button>
        <button disabled={off} onClick={() => void store.duplicate()}>Duplicate</button>
        <button disabled={off} onClick={() => store.remove()}>Delete</button>
      </div>
    </section>
  );
}

function Law({ node, off, set }: { node: GraphNode; off: boolean; set: (key: string[], value: unknown) => void }) {
  const value = node.entry[node.kind];
  if (value !== null && typeof value === "object" && !Array.isArray(value)) {
    const [side, law] = Object.entries(value as Record<string, unknown>)[0] ?? ["e", ""];
    if (typeof law === "string")
      return (
        <label>
          <span>{side} =</span>
          <Field label={`Law, ${side} =`} first value={law} disabled={off} onWrite={(t) => set([node.kind, side], t)} />
        </label>
      );
  }
  if (value !== null && typeof value === "object")
    return <p class="hint">A field or a table: edit it in the text.</p>;
  return (
    <label>
      <span>value</span>
      <Field
        label="Value"
        first
        value={text(value)}
        disabled={off}
        onWrite={(t) => {
          const law = /^\s*([ef])\s*=\s*(.+)$/.exec(t);
          set([node.kind], law ? { [law[1]]: law[2] } : (valueOf(t) ?? 1));
        }}
      />
    </label>
  );
}

/** Which machine switches a junction, and a new one with a click. */
function Switching({ store, state, node }: Props & { node: GraphNode }) {
  const look = state.look!;
  if (node.machine)
    return (
      <p>
        switched by <button class="link" onClick={() => store.set({ tab: "machines" })}>{node.machine}</button>
      </p>
    );
  if (node.law) return null;
  const make = () =>
    void store
      .edit({
        do: "set",
        path: ["machines", free(Object.keys(look.panels.machines), `${node.name}_switch`)],
        value: { states: { on: [node.name], off: [] }, start: "on", rules: [] },
      })
      .then(() => store.set({ tab: "machines" }));
  return (
    <button disabled={!look.view.editable} onClick={make}>
      Let a state machine switch it
    </button>
  );
}

export function free(taken: string[], stem: string): string {
  if (!taken.includes(stem)) return stem;
  for (let k = 2; ; k++) if (!taken.includes(`${stem}${k}`)) return `${stem}${k}`;
}

export function text(value: unknown): string {
  return value === undefined || value === null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
}

/** Names that an expression of this level may read. */
export function words(state: State): string[] {
  const look = state.look;
  if (!look) return [];
  const found: string[] = ["time"];
  for (const n of look.view.nodes) {
    found.push(`${n.name}.e`, `${n.name}.f`);
    if (n.kind === "C") found.push(`${n.name}.q`);
    if (n.kind === "I") found.push(`${n.name}.p`);
  }
  found.push(...Object.keys(look.panels.machines).map((m) => `${m}.state`), ...(state.run?.names ?? []));
  found.push("pre", "abs", "min", "max", "sqrt", "sin", "cos", "exp", "and", "or", "not");
  found.push(...look.view.signals.map((s) => s.name), ...Object.keys(look.panels.parameters));
  return [...new Set(found)];
}
