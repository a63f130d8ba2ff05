/** Parameters, inputs, signals; problems; all as a table; the text. */
import { useEffect, useState } from "preact/hooks";
import { Field, valueOf } from "./fields";
import { free, text, words } from "./item";
import type { State, Store } from "./store";
import { SweepFields } from "./sweeps";

interface Props {
  store: Store;
  state: State;
}

export function ModelPanel({ store, state }: Props) {
  const look = state.look!;
  const off = !look.view.editable;
  const experiment = look.panels.experiment;
  const set = (path: string[], value: unknown) => store.edit({ do: "set", path, value });
  const section = (name: "parameters" | "signals" | "inputs", about: string, first: unknown) => {
    const entries = Object.entries(look.panels[name]);
    return (
      <>
        <h2>{about}</h2>
        {entries.map(([key, value]) => (
          <Entry key={key} store={store} state={state} section={name} name={key} value={value} />
        ))}
        {!off && (
          <button
            onClick={() => {
              const stem = { parameters: "k", signals: "y", inputs: "u" }[name];
              const taken = [...Object.keys(look.panels.parameters), ...look.view.nodes.map((n) => n.name), ...look.view.signals.map((s) => s.name)];
              void set([name, free(taken, stem)], first);
            }}
          >
            Add
          </button>
        )}
      </>
    );
  };
  return (
    <section>
      {section("parameters", "Parameters", 1)}
      {section("signals", "Signals", "time")}
      {section("inputs", "Inputs", { constant: 1 })}
      {!state.level && (
        <>
          <h2>Run</h2>
          <label>
            <span>until</span>
            <Field label="Until" value={text(experiment.until)} placeholder="1 s" onWrite={(t) => void set(["experiment", "until"], valueOf(t))} />
          </label>
          <label>
            <span>solver</span>
            <select value={text(experiment.solver)} onChange={(e) => void set(["experiment", "solver"], e.currentTarget.value || null)}>
              <option value="">auto</option>
              {state.stock?.solvers.filter((s) => s.name !== "auto").map((s) => <option value={s.name} title={s.about}>{s.name}</option>)}
            </select>
          </label>
          <label>
            <span>rtol</span>
            <Field label="Relative tolerance" value={text(experiment.rtol)} placeholder="1e-8" onWrite={(t) => void set(["experiment", "rtol"], valueOf(t))} />
          </label>
        </>
      )}
    </section>
  );
}

const QUANTITY = /^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(\s*\S.*)?$/i;

/** One name and its value; a parameter that is a number has a slider that runs the model again. */
function Entry({ store, state, section, name, value }: Props & { section: string; name: string; value: unknown }) {
  const off = !state.look!.view.editable;
  const plain = typeof value !== "object";
  const found = section === "parameters" ? QUANTITY.exec(text(value)) : null;
  const [base] = useState(() => (found ? Number(found[1]) || 1 : 1));
  const [ranging, setRanging] = useState(false);
  const path = state.level ? `${state.level}.${name}` : name;
  const scaled = (by: number) => `${+((Number(found?.[1]) || 1) * by).toPrecision(6)}${found?.[2] ?? ""}`;
  return (
    <div class="entry" data-entry={name}>
      <label>
        <Field label={`Name ${name}`} value={name} disabled={off} onWrite={(t) => void store.edit({ do: "rename", old: name, new: t.trim() })} />
        {plain ? (
          <Field label={name} value={text(value)} disabled={off} list={section === "signals" ? words(state) : undefined} onWrite={(t) => void store.edit({ do: "set", path: [section, name], value: valueOf(t) })} />
        ) : (
          <Structured store={store} path={[section, name]} value={value as Record<string, unknown>} off={off} />
        )}
        {found && (
          <button class="small" aria-label={`Sweep ${name}`} title="Run over a range" aria-pressed={ranging} onClick={() => setRanging(!ranging)}>
            ⋯
          </button>
        )}
        {!off && (
          <button class="small" aria-label={`Delete ${name}`} onClick={() => void store.edit({ do: "set", path: [section, name], value: null })}>
            ✕
          </button>
        )}
      </label>
      {ranging && found && <SweepFields store={store} path={path} low={scaled(0.5)} high={scaled(2)} onDone={() => setRanging(false)} />}
      {found && !off && (
        <input
          type="range"
          aria-label={`Slider ${name}`}
          min={-1}
          max={1}
          step={0.02}
          value={Math.log10(Math.abs(Number(found[1]) || 1) / Math.abs(base))}
          onChange={(e) => {
            const scaled = +(Math.sign(base) * Math.abs(base) * 10 ** Number(e.currentTarget.value)).toPrecision(4);
            const unit = found[2] ?? "";
            void store
              .edit({ do: "set", path: [section, name], value: unit ? `${scaled}${unit}` : scaled })
              .then(() => state.run && store.start());
          }}
        />
      )}
    </div>
  );
}

function Structured({ store, path, value, off }: { store: Store; path: string[]; value: Record<string, unknown>; off: boolean }) {
  return (
    <span class="structured">
      {Object.entries(value).map(([key, inner]) =>
        typeof inner === "object" && inner !== null && !Array.isArray(inner) ? (
          <Structured store={store} path={[...path, key]} value={inner as Record<string, unknown>} off={off} />
        ) : (
          <label>
            <span>{key}</span>
            <Field
              label={`${path.join(" ")} ${key}`}
              value={text(inner)}
              disabled={off}
              onWrite={(t) => {
                let v: unknown = valueOf(t);
                if (t.trim().startsWith("["))
                  try {
                    v = JSON.parse(t);
                  } catch {
                    /* it stays a text, and is refused as one */
                  }
                void store.edit({ do: "set", path: [...path, key], value: v });
              }}
            />
          </label>
        ),
      )}
    </span>
  );
}

export function Problems({ store, state }: Props) {
  const found = state.look!.problems;
  return (
    <section>
      <h2>Problems</h2>
      {!found.length && <p>None.</p>}
      <ul class="problems">
        {found.map((p) => (
          <li class={p.grave}>
            <button onClick={() => store.select(p.select)}>
              <b>{p.code}</b> {p.where && <i>{p.where}</i>}
              <span>{p.why}</span>
              {p.try && <em>Try: {p.try}</em>}
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}

/** The same graph as tables, for those who do not see the canvas or prefer to read. */
export function TableView({ store, state }: Props) {
  const { view, strokes } = state.look!;
  return (
    <section class="tables">
      <h2>Elements</h2>
      <table>
        <thead>
          <tr><th scope="col">name</th><th scope="col">kind</th><th scope="col">value</th><th scope="col">state</th></tr>
        </thead>
        <tbody>
          {view.nodes.map((n) => {
            const s = strokes.nodes[n.name];
            return (
              <tr class={state.nodes.has(n.name) ? "chosen" : ""}>
                <td><button class="link" onClick={() => store.set({ nodes: new Set([n.name]), bonds: new Set() })}>{n.name}</button></td>
                <td>{n.kind === "part" ? String(n.entry.submodel) : n.kind}</td>
                <td>{s?.says ?? n.says}</td>
                <td>{[s?.off ? "OFF" : s?.controlled ? "ON" : "", s?.derivative ? "derivative" : "", n.law ?? "", n.machine ?? ""].filter(Boolean).join(", ")}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      <h2>Bonds</h2>
      <table>
        <thead>
          <tr><th scope="col">bond</th><th scope="col">stroke at</th><th scope="col">other modes</th></tr>
        </thead>
        <tbody>
          {view.bonds.map((b) => {
            const s = strokes.bonds[b.key] ?? strokes.bonds[`${b.ends[0]} -> ${b.ends[1]}`];
            return (
              <tr class={state.bonds.has(b.key) ? "chosen" : ""}>
                <td><button class="link" onClick={() => store.set({ bonds: new Set([b.key]), nodes: new Set() })}>{b.text}</button></td>
                <td>{s ? s.strokes.map((e) => b.ends[e]).join(", ") + (s.conflict ? " (conflict)" : "") + (s.off ? " (OFF)" : "") : "—"}</td>
                <td>{s?.dashed?.map((e) => b.ends[e]).join(", ") ?? ""}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </section>
  );
}

/** The text of the file, editable; what is not applied yet stays until it is. */
export function TextPanel({ store, state }: Props) {
  const [shown, setShown] = useState<{ text: string; revision: number } | null>(null);
  const [mine, setMine] = useState<string | null>(null);
  const revision = state.look!.revision;
  useEffect(() => {
    let gone = false;
    void store.transport.ask<{ text: string; revision: number }>("text").then((a) => !gone && setShown(a)).catch(() => {});
    return () => {
      gone = true;
    };
  }, [revision]);
  const apply = () => {
    if (mine !== null) void store.ask("replace", { text: mine }).then((look) => look && setMine(null));
  };
  return (
    <section class="textpanel">
      <h2>
        {state.look!.file} {mine !== null && <small>not applied</small>}
      </h2>
      <textarea
        aria-label="Text of the model file"
        spellcheck={false}
        value={mine ?? shown?.text ?? ""}
        onInput={(e) => setMine(e.currentTarget.value)}
        onKeyDown={(e) => {
          if (e.key === "Enter" && (e.ctrlKey || e.metaKey)) apply();
          e.stopPropagation();
        }}
      />
      <div class="row">
        <button disabled={mine === null} onClick={apply}>Apply (Ctrl+Enter)</button>
        <button disabled={mine === null} onClick={() => setMine(null)}>Discard</button>
      </div>
    </section>
  );
}
