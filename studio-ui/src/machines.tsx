/** State machines: states as boxes, rules as labelled arrows, guards as text with names completed. */
import { ExpressionField } from "./expression";
import { Field } from "./fields";
import { free, words } from "./item";
import type { MachineEntry, Problem } from "./messages";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

interface Rule {
  source: string;
  target: string;
  guard: string;
}

export function readRule(text: string): Rule | null {
  const found = /^\s*(\w+)\s*->\s*(\w+)\s+when\s+(.+)$/s.exec(text);
  return found ? { source: found[1], target: found[2], guard: found[3] } : null;
}

export function Machines({ store, state }: Props) {
  const look = state.look!;
  const entries = Object.entries(look.panels.machines);
  const add = () => {
    const junction = look.view.nodes.find((n) => state.nodes.has(n.name) && (n.kind === "0" || n.kind === "1"));
    const name = free([...entries.map(([n]) => n), ...look.view.nodes.map((n) => n.name)], "S");
    void store.edit({
      do: "set",
      path: ["machines", name],
      value: { states: { on: junction ? [junction.name] : [], off: [] }, start: "on", rules: [] },
    });
  };
  return (
    <section>
      <h2>State machines</h2>
      {entries.map(([name, machine]) => (
        <MachineEditor key={name} store={store} state={state} name={name} machine={machine} />
      ))}
      {look.view.editable && <button onClick={add}>New machine</button>}
      <p class="hint">
        In guards <code>pre(x)</code> is the value before the instant (a priori <b>x⁻</b>), <code>x</code> the one that
        holds after it (a posteriori <b>x⁺</b>).
      </p>
    </section>
  );
}

function MachineEditor({ store, state, name, machine }: Props & { name: string; machine: MachineEntry }) {
  const look = state.look!;
  const off = !look.view.editable;
  const path = state.level ? `${state.level}.${name}` : name;
  const now = state.cursor?.mode[path] ?? look.machines.find((m) => m.path === path)?.state;
  const states = Object.keys(machine.states ?? {});
  const rules = machine.rules ?? [];
  const write = (value: MachineEntry) => void store.edit({ do: "set", path: ["machines", name], value });
  const setRule = (k: number, text: string | null) =>
    write({ ...machine, rules: text === null ? rules.filter((_, j) => j !== k) : rules.map((r, j) => (j === k ? text : r)) });
  /** What would be wrong with a rule that reads so; what is wrong elsewhere is not its fault. */
  const attempt = async (k: number, text: string): Promise<Problem | null> => {
    const value = { ...machine, rules: rules.map((r, j) => (j === k ? text : r)) };
    const edit = { do: "set", path: ["machines", name], value, level: state.level };
    const { problem } = await store.transport.ask<{ problem: Problem | null }>("attempt", { edit });
    return problem?.where.includes(name) ? problem : null;
  };
  const switchable = look.view.nodes.filter((n) => n.kind !== "part" && n.kind !== "?").map((n) => n.name);
  return (
    <div class="machine" data-machine={name}>
      <div class="row">
        <Field label={`Name of machine ${name}`} value={name} disabled={off} onWrite={(t) => void store.edit({ do: "rename", old: name, new: t.trim() })} />
        {!off && (
          <button class="small" aria-label={`Delete machine ${name}`} onClick={() => void store.edit({ do: "set", path: ["machines", name], value: null })}>
            ✕
          </button>
        )}
      </div>
      <Diagram machine={machine} now={now} onState={(s) => store.setMode(path, s)} />
      {states.map((s) => (
        <div class="row state">
          <input type="radio" name={`start-${name}`} aria-label={`${name} starts in ${s}`} title="start state" checked={machine.start === s} disabled={off} onChange={() => write({ ...machine, start: s })} />
          <Field
            label={`State ${s} of ${name}`}
            value={s}
            disabled={off}
            onWrite={(t) => {
              const to = t.trim();
              if (!to) {
                const { [s]: _, ...rest } = machine.states;
                return write({ ...machine, states: rest, start: machine.start === s ? Object.keys(rest)[0] : machine.start });
              }
              void store.edit({ do: "rename state", machine: name, old: s, new: to });
            }}
          />
          <span class="on">ON</span>
          <Field
            label={`Junctions that state ${s} of ${name} switches on`}
            value={(machine.states[s] ?? []).join(", ")}
            disabled={off}
            list={switchable}
            placeholder="none"
            onWrite={(t) => write({ ...machine, states: { ...machine.states, [s]: t.split(/[\s,]+/).filter(Boolean) } })}
          />
        </div>
      ))}
      {rules.map((r, k) => {
        const rule = readRule(r);
        const pre = rule && /\bpre\s*\(/.test(rule.guard);
        return (
          <div class="row rule">
            {rule ? (
              <>
                <select disabled={off} aria-label="From" value={rule.source} onChange={(e) => setRule(k, `${e.currentTarget.value} -> ${rule.target} when ${rule.guard}`)}>
                  {states.map((s) => <option>{s}</option>)}
                </select>
                →
                <select disabled={off} aria-label="To" value={rule.target} onChange={(e) => setRule(k, `${rule.source} -> ${e.currentTarget.value} when ${rule.guard}`)}>
                  {states.map((s) => <option>{s}</option>)}
                </select>
                <ExpressionField
                  label={`Guard ${k + 1} of ${name}`}
                  value={rule.guard}
                  disabled={off}
                  words={words(state)}
                  check={(t) => attempt(k, `${rule.source} -> ${rule.target} when ${t}`)}
                  onWrite={(t) => setRule(k, `${rule.source} -> ${rule.target} when ${t}`)}
                />
                <span class={"reads " + (pre ? "prior" : "after")} title={pre ? "reads a priori values, x⁻" : "reads a posteriori values, x⁺"}>
                  {pre ? "x⁻" : "x⁺"}
                </span>
              </>
            ) : (
              <Field label={`Rule ${k + 1} of ${name}`} value={r} disabled={off} onWrite={(t) => setRule(k, t)} />
            )}
            {!off && (
              <button class="small" aria-label={`Delete rule ${k + 1} of ${name}`} onClick={() => setRule(k, null)}>
                ✕
              </button>
            )}
          </div>
        );
      })}
      {!off && (
        <div class="row">
          <button onClick={() => write({ ...machine, states: { ...machine.states, [free(states, "state")]: [] } })}>Add state</button>
          <button
            disabled={states.length < 2}
            onClick={() => {
              const out = states.find((s) => !rules.some((r) => readRule(r)?.source === s)) ?? states[0];
              const into = states.find((s) => s !== out)!;
              write({ ...machine, rules: [...rules, `${out} -> ${into} when time >= 1`] });
            }}
          >
            Add rule
          </button>
        </div>
      )}
    </div>
  );
}

/** States as boxes in a row, rules as arcs above (forwards) and below (backwards). */
function Diagram({ machine, now, onState }: { machine: MachineEntry; now?: string; onState: (s: string) => void }) {
  const states = Object.keys(machine.states ?? {});
  const pitch = 108;
  const at = (s: string) => 46 + pitch * states.indexOf(s);
  const rules = (machine.rules ?? []).map(readRule).filter((r): r is Rule => !!r && states.includes(r.source) && states.includes(r.target));
  const count = new Map<string, number>();
  const reach = Math.max(1, ...rules.map((r) => Math.abs(states.indexOf(r.target) - states.indexOf(r.source))));
  const up = 26 + 16 * reach;
  return (
    <div class="diagram">
    <svg width={46 + pitch * states.length} height={2 * up + 10} viewBox={`0 ${-up} ${46 + pitch * states.length} ${2 * up + 10}`} role="group" aria-label="States and rules">
      <defs>
        <marker id="rulehead" viewBox="0 0 8 8" refX={7} refY={4} markerWidth={7} markerHeight={7} orient="auto">
          <path d="M0,1L8,4L0,7z" class="rulehead" />
        </marker>
      </defs>
      {rules.map((r) => {
        const [a, b] = [at(r.source), at(r.target)];
        const key = `${r.source}>${r.target}`;
        const nth = count.get(key) ?? 0;
        count.set(key, nth + 1);
        if (a === b) return <path class="arc" d={`M${a - 8},-14 C${a - 26},-44 ${a + 26},-44 ${a + 8},-14`} marker-end="url(#rulehead)"><title>{r.guard}</title></path>;
        const sign = b > a ? -1 : 1;
        const high = sign * (22 + 14 * Math.abs(b - a) / pitch + 9 * nth);
        const words = r.guard.length > 26 ? r.guard.slice(0, 25) + "…" : r.guard;
        return (
          <g>
            <path class="arc" d={`M${a},${14 * sign} C${a},${high} ${b},${high} ${b},${14 * sign}`} marker-end="url(#rulehead)"><title>{r.guard}</title></path>
            <text class="guard" x={(a + b) / 2} y={0.78 * high + (sign < 0 ? -3 : 10)} text-anchor="middle">{words}</text>
          </g>
        );
      })}
      {states.map((s) => (
        <g
          class={"statebox" + (s === now ? " now" : "") + (s === machine.start ? " start" : "")}
          role="button"
          tabindex={0}
          aria-label={`Show state ${s}`}
          aria-pressed={s === now}
          onClick={() => onState(s)}
          onKeyDown={(e) => (e.key === "Enter" || e.key === " ") && onState(s)}
        >
          <rect x={at(s) - 38} y={-14} width={76} height={28} rx={8} />
          <text x={at(s)} y={4} text-anchor="middle">{s.length > 11 ? s.slice(0, 10) + "…" : s}</text>
          {s === machine.start && <circle cx={at(s) - 38} cy={-14} r={4} />}
        </g>
      ))}
    </svg>
    </div>
  );
}
