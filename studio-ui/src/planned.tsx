/** A sweep of a plan: how far it is, its views, and one of its runs. */
import { useEffect, useRef, useState } from "preact/hooks";
import { said } from "./axes";
import { Bands } from "./bands";
import { Sobol, Tornado } from "./bars";
import type { Choice, MemberOf, PlanNow, Problem, TableOf, ViewOf } from "./messages";
import { Outcomes } from "./outcomes";
import type { State, Store } from "./store";

const VIEWS: [string, string][] = [
  ["map", "Map"],
  ["scatter", "Scatter"],
  ["family", "Curves"],
  ["tornado", "Tornado"],
  ["sobol", "Sobol indices"],
  ["table", "Table"],
];
/** What stands above a picture, pixels. */
const BARS = 92;
/** As in the style sheet: there the page scrolls, and a picture is as high as it likes. */
const NARROW = "(max-width: 760px)";
/** Least time between two pictures of a sweep that goes on, ms. */
const PICTURE = 500;
/** How much longer nothing is asked than the last picture took. */
const SHARE = 4;

export function PlanView({ store, state, plan }: { store: Store; state: State; plan: PlanNow }) {
  const { choice, chosen } = state.looked?.plan === plan.plan ? state.looked : { choice: first(plan), chosen: null };
  const [[wide, low], setRoom] = useState<[number, number]>([700, 340]);
  const box = useRef<HTMLDivElement>(null);
  useEffect(() => {
    const e = box.current;
    if (!e) return;
    const watch = new ResizeObserver(() => setRoom([Math.max(260, e.clientWidth - 24), matchMedia(NARROW).matches ? 0 : e.clientHeight]));
    watch.observe(e);
    return () => watch.disconnect();
  }, []);
  const set = (patch: Partial<Choice>) => store.set({ looked: { plan: plan.plan, choice: { ...choice, ...patch }, chosen } });
  const choose = (member: number) => store.set({ looked: { plan: plan.plan, choice, chosen: member } });
  const numeric = [...plan.factors.filter((f) => f.number).map((f) => f.path), ...plan.columns.filter((c) => c.kind === "number" || c.kind === "whole").map((c) => c.name)];
  const single = plan.columns.filter((c) => c.kind !== "curve").map((c) => c.name);
  const pick = (label: string, key: "x" | "y" | "value" | "curve", names: string[]) => (
    <label>
      {label}
      <select aria-label={label} value={choice[key]} onChange={(e) => set({ [key]: e.currentTarget.value })}>
        {names.map((n) => <option>{n}</option>)}
      </select>
    </label>
  );
  const open = (member: number) => void store.openMember(member);
  const high = low ? Math.max(low - BARS, 190) : Math.round(Math.min(0.8 * wide, 340));
  const factors = plan.factors.map((f) => f.path);
  const others = plan.way === "grid" && choice.view === "map" ? plan.factors.filter((f) => f.levels.length > 1 && f.path !== choice.x && f.path !== choice.y) : [];
  const sliced = others.length > 0 && factors.includes(choice.x) && factors.includes(choice.y);
  const at = sliced ? Object.fromEntries(others.map((f) => [f.path, choice.at[f.path] ?? 0])) : {};
  const [seen, refused] = useSeen(store, plan, { ...choice, at });
  return (
    <section class="plots planned" ref={box} aria-label="Sweep">
      <div class="plotbar">
        <Progress store={store} plan={plan} />
        <One store={store} plan={plan} chosen={chosen} choose={choose} open={open} />
        <button onClick={() => void download(store, plan)} disabled={!plan.kept}>Table as CSV</button>
        <button onClick={() => store.set({ planShown: false })}>Plots</button>
      </div>
      <div class="plotbar">
        <div class="choices" role="group" aria-label="Views">
          {VIEWS.map(([view, word]) => (
            <button aria-pressed={choice.view === view} onClick={() => set({ view, ...defaults(plan, view) })}>
              {word}
            </button>
          ))}
        </div>
        {(choice.view === "map" || choice.view === "scatter") && (
          <>
            {pick("of", "value", choice.view === "map" ? single : [...single, "status", ...factors])}
            {pick("across", "x", numeric)}
            {pick("up", "y", numeric)}
          </>
        )}
        {choice.view === "family" && pick("of", "curve", plan.columns.filter((c) => c.kind === "curve").map((c) => c.name))}
        {(choice.view === "tornado" || choice.view === "sobol") && pick("of", "value", numeric.filter((n) => !factors.includes(n)))}
        {sliced &&
          others.map((f) => (
            <label>
              {f.path}
              <select aria-label={`Level of ${f.path}`} value={at[f.path]} onChange={(e) => set({ at: { ...choice.at, [f.path]: Number(e.currentTarget.value) } })}>
                {f.levels.map((level, k) => <option value={k}>{level}</option>)}
              </select>
            </label>
          ))}
      </div>
      {plan.error && (
        <p class="wrong">
          {plan.error.code} {plan.error.where} {plan.error.why} <em>{plan.error.try}</em>
        </p>
      )}
      {refused ? (
        <p class="hint">
          {refused.why}. {how(plan, choice.view) || refused.try}
        </p>
      ) : !seen ? (
        <p class="hint">{plan.kept ? "…" : plan.state === "running" ? "The first runs are on their way …" : "No run was done."}</p>
      ) : seen.view === "table" ? (
        <Rows found={seen} open={open} turn={(to) => set({ first: to })} />
      ) : seen.view === "family" ? (
        <Bands found={seen} wide={Math.min(wide, 4 * high)} high={high} chosen={chosen} choose={choose} open={open} />
      ) : seen.view === "tornado" ? (
        <Tornado found={seen} wide={wide} open={open} />
      ) : seen.view === "sobol" ? (
        <Sobol found={seen} wide={wide} />
      ) : (
        <Outcomes found={seen} wide={Math.min(wide, 4 * high)} high={high} dark={state.dark} chosen={chosen} choose={choose} open={open} />
      )}
    </section>
  );
}

/** What to do where a plan has no such view; empty if it has, and what lacks is something else. */
function how(plan: PlanNow, view: string): string {
  const way = plan.way.split(":")[0];
  if (view === "tornado" && way !== "ends") return "Draw members ‘for a tornado’.";
  if (view === "sobol" && way !== "saltelli") return "Draw members ‘for Sobol indices’.";
  return view === "family" && !plan.columns.some((c) => c.kind === "curve") ? "Collect a curve: curve(height, 101)." : "";
}

function Progress({ store, plan }: { store: Store; plan: PlanNow }) {
  const left = plan.left === null ? "" : plan.left < 1 ? ", under 1 s to go" : plan.left < 120 ? `, ${Math.round(plan.left)} s to go` : plan.left < 7200 ? `, ${Math.round(plan.left / 60)} min to go` : `, ${(plan.left / 3600).toFixed(1)} h to go`;
  const of = plan.factors.map((f) => f.path).join(", ");
  if (plan.state === "running")
    return (
      <>
        <progress aria-label="Progress of the sweep" max={plan.members} value={plan.done} />
        <span>
          {plan.done} of {plan.members} runs{left}
        </span>
        <button onClick={() => void store.transport.ask("plan cancel").catch(() => {})}>Cancel</button>
      </>
    );
  return (
    <span role="status">
      <b>{of}</b>: {plan.state === "done" ? `${plan.members} runs` : `${plan.kept} of ${plan.members} runs, ${plan.state === "cancelled" ? "cancelled" : "stopped"}`}
    </span>
  );
}

/** One run of the sweep: by its number, what it was run with, what came of it. */
function One({ store, plan, chosen, choose, open }: { store: Store; plan: PlanNow; chosen: number | null; choose: (k: number) => void; open: (k: number) => void }) {
  const [found, setFound] = useState<MemberOf | null>(null);
  useEffect(() => {
    setFound(null);
    if (chosen === null) return;
    let gone = false;
    store.transport
      .ask<MemberOf>("plan member", { plan: plan.plan, member: chosen })
      .then((a) => !gone && setFound(a))
      .catch((e) => store.refused(e));
    return () => {
      gone = true;
    };
  }, [chosen, plan.plan, plan.state]);
  const sets = found && found.member === chosen ? Object.entries(found.sets) : [];
  const parameters = store.state.look?.panels.parameters ?? {};
  const take = async () => {
    for (const [path, value] of sets) if (!(await store.edit({ do: "set", path: ["parameters", path], value, level: "" }))) return;
    await store.start();
  };
  return (
    <div class="plotbar one">
      <label>
        run
        <input type="number" aria-label="Run of the sweep" min={0} max={plan.members - 1} value={chosen ?? ""} onKeyDown={(e) => (e.stopPropagation(), e.key === "Enter" && chosen !== null && open(chosen))} onInput={(e) => {
          const k = Number(e.currentTarget.value);
          if (e.currentTarget.value && Number.isInteger(k) && k >= 0 && k < plan.members) choose(k);
        }} />
      </label>
      {chosen !== null && (
        <>
          <output>
            {sets.map(([path, value]) => `${path} = ${shortened(value)}`).join(", ")}
            {found?.row && plan.columns.filter((c) => c.kind !== "curve").map((c) => `; ${c.name} = ${cell(found.row![c.name])}`).join("")}
            {found?.row?.code && `; ${found.row.status}: ${found.row.code} ${found.row.message}`}
          </output>
          <button onClick={() => open(chosen)}>Open</button>
          {sets.length > 0 && sets.every(([path]) => path in parameters) && <button onClick={() => void take()}>Take these values</button>}
        </>
      )}
    </div>
  );
}

function Rows({ found, open, turn }: { found: TableOf; open: (member: number) => void; turn: (first: number) => void }) {
  const shown = found.columns.map((_, k) => k).filter((k) => k === 0 || !["code", "message", "warnings"].includes(found.columns[k].name) || found.rows.some((r) => r[k]));
  const figures = new Set(shown.filter((k) => found.rows.some((r) => typeof r[k] === "number")));
  const last = found.first + found.rows.length;
  return (
    <div class="rows">
      <div class="tables" tabindex={0} role="region" aria-label="Table of the sweep">
        <table>
          <thead>
            <tr>
              {shown.map((k) => (
                <th scope="col" class={figures.has(k) ? "figure" : ""}>
                  {found.columns[k].name}
                  {found.columns[k].unit && ` [${found.columns[k].unit}]`}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {found.rows.map((row) => (
              <tr>
                {shown.map((k) => (
                  <td class={figures.has(k) ? "figure" : ""}>{k === 0 ? <button class="link" onClick={() => open(Number(row[0]))}>{row[0]}</button> : cell(row[k])}</td>
                ))}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <div class="plotbar">
        <button disabled={!found.first} onClick={() => turn(Math.max(found.first - 200, 0))}>Before</button>
        <span>
          {found.first} to {last - 1} of {found.kept}
        </span>
        <button disabled={last >= found.kept} onClick={() => turn(last)}>After</button>
      </div>
    </div>
  );
}

function cell(v: string | number | null | undefined): string {
  return typeof v === "number" ? said(v) : (v ?? "none");
}

/** A value as it is set, with fewer digits. */
function shortened(value: string | number): string {
  const [figure, ...unit] = String(value).split(" ");
  return Number.isFinite(Number(figure)) ? [said(Number(figure)), ...unit].join(" ") : String(value);
}

/** What a view is of, at first. */
function defaults(plan: PlanNow, view: string): Partial<Choice> {
  const factors = plan.factors.filter((f) => f.number).map((f) => f.path);
  const numbers = plan.columns.filter((c) => c.kind === "number" || c.kind === "whole").map((c) => c.name);
  const words = plan.columns.filter((c) => c.kind === "text").map((c) => c.name);
  const [x = "", y = factors[0] ?? ""] = factors;
  switch (view) {
    case "map":
      return { value: words.includes("sequence") ? "sequence" : (numbers[0] ?? words[0] ?? ""), x, y };
    case "scatter":
      return { value: words[0] ?? "status", x: numbers.length > 1 ? numbers[0] : x, y: numbers[1] ?? numbers[0] ?? y };
    case "family":
      return { curve: plan.columns.find((c) => c.kind === "curve")?.name ?? "" };
    default:
      return { value: numbers[0] ?? "" };
  }
}

function first(plan: PlanNow): Choice {
  const way = plan.way.split(":")[0];
  const curve = plan.columns.find((c) => c.kind === "curve");
  const many = plan.factors.filter((f) => f.number).length;
  const view = way === "ends" ? "tornado" : way === "saltelli" ? "sobol" : curve && (many < 2 || plan.columns.length === 1) ? "family" : many < 2 ? "scatter" : "map";
  return { view, x: "", y: "", value: "", curve: "", at: {}, first: 0, ...defaults(plan, view) };
}

/** What a view shows; asked for again when there is more of the sweep, but not too often. */
function useSeen(store: Store, plan: PlanNow, choice: Choice): [ViewOf | null, Problem | null] {
  const [answer, setAnswer] = useState<{ key: string; seen: ViewOf | null; refused: Problem | null }>({ key: "", seen: null, refused: null });
  const key = JSON.stringify([plan.plan, choice]);
  const wanted = useRef({ key: "", kept: -1, ended: false });
  const busy = useRef(false);
  const gone = useRef(false);
  const ask = async () => {
    if (busy.current) return;
    busy.current = true;
    let served = "";
    while (!gone.current && JSON.stringify(wanted.current) !== served) {
      const now = wanted.current;
      served = JSON.stringify(now);
      const [number, own] = JSON.parse(now.key);
      const began = performance.now();
      try {
        const seen = await store.transport.ask<ViewOf>("plan view", { plan: number, ...own });
        if (now.key === wanted.current.key) setAnswer({ key: now.key, seen, refused: null });
      } catch (error) {
        const refused = (error as { problem?: Problem }).problem ?? null;
        if (now.key === wanted.current.key) setAnswer({ key: now.key, seen: null, refused });
      }
      const same = now.key === wanted.current.key;
      const rest = Math.max(PICTURE, SHARE * (performance.now() - began));
      if (same && !wanted.current.ended) await new Promise((done) => setTimeout(done, rest));
    }
    busy.current = false;
  };
  useEffect(() => {
    gone.current = false;
    return () => {
      gone.current = true;
    };
  }, []);
  useEffect(() => {
    wanted.current = { key, kept: plan.kept, ended: plan.state !== "running" };
    if (plan.kept) void ask();
  }, [key, plan.kept, plan.state]);
  const current = answer.seen && JSON.parse(answer.key || "[]")[0] === plan.plan && answer.seen.view === choice.view ? answer.seen : null;
  return [current, answer.key === key ? answer.refused : null];
}

async function download(store: Store, plan: PlanNow): Promise<void> {
  try {
    const { text, name } = await store.transport.ask<{ text: string; name: string }>("plan csv", { plan: plan.plan });
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    link.download = name;
    link.click();
    URL.revokeObjectURL(link.href);
  } catch (error) {
    store.refused(error);
  }
}
