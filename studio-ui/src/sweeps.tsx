/** A sweep: curves of all members as a family, and which mode each is in over time as a map. */
import { useState } from "preact/hooks";
import type { Curve, Swept } from "./messages";
import { number, quantity } from "./quantities";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

const [WIDE, HIGH] = [720, 190];
const LEFT = 74;
const [TOP, LOW] = [8, 20];
const FILLS = ["var(--s0)", "var(--s1)", "var(--s2)", "var(--s3)", "var(--s4)", "var(--s5)", "var(--s6)", "var(--s7)"];

/** From the first value to the last: blue to red over violet, told apart also where colours are not. */
function ink(part: number): string {
  return `color-mix(in oklab, var(--c5) ${Math.round(100 * part)}%, var(--c1))`;
}

export function SweepView({ store, state }: Props) {
  const sweep = state.sweep!;
  const [chosen, choose] = useState<number | null>(null);
  const members = sweep.members.filter((m) => m);
  const names = members.length ? (members.find((m) => m.curves)?.curves ?? []).map((c) => c.name) : [];
  const failed = members.filter((m) => m.error);
  const end = members.find((m) => m.until !== undefined)?.until ?? 1;
  const use = () => {
    const value = sweep.values[chosen!];
    const path = sweep.path.split(".");
    if (path.length === 1) void store.edit({ do: "set", path: ["parameters", sweep.path], value, level: "" }).then(() => store.start());
  };
  return (
    <div class="plots sweep">
      <div class="plotbar">
        <b>{sweep.path}</b> from {sweep.values[0]} to {sweep.values[sweep.values.length - 1]}
        <span class="scale" aria-hidden="true" />
        <span role="status">
          {sweep.done ? `${members.length} runs${members.length < sweep.values.length ? ", cancelled" : ""}` : `${members.length} of ${sweep.values.length}`}
          {failed.length > 0 && `, ${failed.length} stopped: ${failed[0].error!.code}`}
        </span>
        {!sweep.done && <button onClick={store.cancel}>Cancel</button>}
        <input type="range" aria-label={`Run of the sweep over ${sweep.path}`} min={0} max={sweep.values.length - 1} step={1} value={chosen ?? 0} onInput={(e) => choose(Number(e.currentTarget.value))} />
        {chosen !== null && (
          <>
            <output>
              {sweep.path} = {sweep.values[chosen]}
            </output>
            {!sweep.path.includes(".") && <button onClick={use}>Take this value</button>}
          </>
        )}
        <button onClick={() => store.set({ sweep: null })}>Close</button>
      </div>
      {names.map((name, k) => (
        <Family key={name} name={name} curves={sweep.members.map((m) => m?.curves?.[k])} end={end} chosen={chosen} choose={choose} />
      ))}
      <ModeMap sweep={sweep} end={end} chosen={chosen} choose={choose} />
    </div>
  );
}

interface Chosen {
  chosen: number | null;
  choose: (k: number | null) => void;
}

function Family({ name, curves, end, chosen, choose }: Chosen & { name: string; curves: (Curve | undefined)[]; end: number }) {
  const good = curves.filter((c): c is Curve => !!c && !c.error);
  let [low, high] = [Infinity, -Infinity];
  for (const c of good)
    for (const v of c.y)
      if (v !== null) [low, high] = [Math.min(low, v), Math.max(high, v)];
  if (!good.length || low > high) return <p class="hint">{name}: {curves.find((c) => c?.error)?.error?.why ?? "no values yet"}</p>;
  const unit = good[0].unit;
  const room = high - low || Math.abs(high) || 1;
  const px = (t: number) => LEFT + (t / end) * (WIDE - LEFT - 8);
  const py = (v: number) => HIGH - LOW - ((v - low) / room) * (HIGH - LOW - TOP);
  const way = (c: Curve) => {
    let d = "";
    let pen = "M";
    c.t.forEach((t, k) => {
      const v = c.y[k];
      if (v === null) pen = "M";
      else {
        d += `${pen}${px(t).toFixed(1)},${py(v).toFixed(1)}`;
        pen = "L";
      }
    });
    return d;
  };
  const order = curves.map((_, k) => k).filter((k) => k !== chosen);
  if (chosen !== null) order.push(chosen);
  return (
    <svg class="family" viewBox={`0 0 ${WIDE} ${HIGH}`} role="img" aria-label={`${name} of ${good.length} runs, between ${number(low)} and ${number(high)} ${unit}`}>
      <rect class="box" x={LEFT} y={TOP} width={WIDE - LEFT - 8} height={HIGH - LOW - TOP} />
      {low < 0 && high > 0 && <line class="axis" x1={LEFT} x2={WIDE - 8} y1={py(0)} y2={py(0)} />}
      {order.map((k) => {
        const c = curves[k];
        if (!c || c.error) return null;
        return (
          <path key={k} class={k === chosen ? "way chosen" : "way"} d={way(c)} style={`stroke: ${ink(k / Math.max(1, curves.length - 1))}`} onClick={() => choose(k)}>
            <title>run {k + 1}</title>
          </path>
        );
      })}
      <text x={LEFT - 5} y={TOP + 9} text-anchor="end">{quantity(high, unit)}</text>
      <text x={LEFT - 5} y={HIGH - LOW} text-anchor="end">{quantity(low, unit)}</text>
      <text class="what" transform={`translate(12,${(HIGH - LOW) / 2}) rotate(-90)`} text-anchor="middle">{name}</text>
      <text x={LEFT} y={HIGH - 5}>0 s</text>
      <text x={WIDE - 8} y={HIGH - 5} text-anchor="end">{quantity(end, "s")}</text>
    </svg>
  );
}

/** A column for each value, time upwards, a colour for each mode. */
function ModeMap({ sweep, end, chosen, choose }: Chosen & { sweep: Swept; end: number }) {
  const named = [...sweep.members].reverse().find((m) => m?.named)?.named ?? [];
  if (named.length < 2) return null;
  const rows = Math.max(...sweep.members.map((m) => m?.modes?.length ?? 0));
  const wide = (WIDE - LEFT - 8) / sweep.values.length;
  const high = 150;
  const stays = (modes: number[]) => {
    const found: [number, number, number][] = [];
    modes.forEach((m, k) => {
      const last = found[found.length - 1];
      if (last && last[2] === m) last[1] = k + 1;
      else found.push([k, k + 1, m]);
    });
    return found;
  };
  return (
    <figure class="modemap">
      <svg viewBox={`0 0 ${WIDE} ${high + 34}`} role="img" aria-label={`Modes over ${sweep.path} and time: ${named.join("; ")}`}>
        {sweep.members.map((m, k) =>
          m?.modes ? (
            <g class={k === chosen ? "chosen" : ""} onClick={() => choose(k)}>
              {stays(m.modes).map(([a, b, mode]) => (
                <rect x={LEFT + k * wide} width={wide + 0.4} y={TOP + high * (1 - b / rows)} height={(high * (b - a)) / rows + 0.4} fill={FILLS[mode % FILLS.length]}>
                  <title>{`${sweep.values[k]}: ${named[mode]}`}</title>
                </rect>
              ))}
            </g>
          ) : null,
        )}
        <text x={LEFT - 5} y={TOP + 9} text-anchor="end">{quantity(end, "s")}</text>
        <text x={LEFT - 5} y={TOP + high} text-anchor="end">0 s</text>
        <text x={LEFT} y={TOP + high + 14}>{sweep.values[0]}</text>
        <text x={WIDE - 8} y={TOP + high + 14} text-anchor="end">{sweep.values[sweep.values.length - 1]}</text>
        <text class="what" x={(LEFT + WIDE) / 2} y={TOP + high + 18} text-anchor="middle">{sweep.path}</text>
      </svg>
      <figcaption>
        {named.slice(0, 16).map((name, k) => (
          <span>
            <i style={`background: ${FILLS[k % FILLS.length]}`} /> {name}
          </span>
        ))}
        {named.length > 16 && ` and ${named.length - 16} more`}
      </figcaption>
    </figure>
  );
}

/** The ends of a range and how many runs, beside a parameter. */
export function SweepFields({ store, path, low, high, onDone }: { store: Store; path: string; low: string; high: string; onDone: () => void }) {
  const [from, setFrom] = useState(low);
  const [to, setTo] = useState(high);
  const [count, setCount] = useState("15");
  const [log, setLog] = useState(false);
  const begin = (e: Event) => {
    e.preventDefault();
    void store.sweep({ path, from, to, count, log }).then((ok) => ok && onDone());
  };
  const field = (label: string, value: string, set: (v: string) => void) => (
    <label>
      <span>{label}</span>
      <input aria-label={`Sweep ${path} ${label}`} value={value} onInput={(e) => set(e.currentTarget.value)} onKeyDown={(e) => e.stopPropagation()} />
    </label>
  );
  return (
    <form class="sweepfields" onSubmit={begin}>
      {field("from", from, setFrom)}
      {field("to", to, setTo)}
      {field("runs", count, setCount)}
      <label>
        <input type="checkbox" checked={log} onChange={(e) => setLog(e.currentTarget.checked)} /> by ratios
      </label>
      <button type="submit">Sweep</button>
    </form>
  );
}
