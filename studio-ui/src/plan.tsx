/** A plan of many runs as a form: what varies, how members are drawn, what is collected. */
import { useEffect, useState } from "preact/hooks";
import { ExpressionField } from "./expression";
import { Field } from "./fields";
import type { PlanForm, PlanWords, Problem, Verdict } from "./messages";
import type { State, Store } from "./store";
import { span } from "./axes";

interface Props {
  store: Store;
  state: State;
}

const PATIENCE = 120;
/** What is right but too large for the page: its command is the way to run it. */
const LARGE = "HB-W103";
/** Ways that take no number of members. */
const WHOLE = ["grid", "together", "ends"];
/** Ways of levels; the others draw from what is between. */
const LEVELS = ["grid", "together"];

export function PlanPanel({ store, state }: Props) {
  const [words, setWords] = useState<PlanWords | null>(null);
  const [refused, setRefused] = useState<Problem | null>(null);
  const [verdict, setVerdict] = useState<Verdict | null>(null);
  const revision = state.look!.revision;
  const form = state.asking;
  useEffect(() => {
    let gone = false;
    store.transport
      .ask<PlanWords>("plan words")
      .then((found) => {
        if (gone) return;
        setWords(found);
        setRefused(null);
        if (!store.state.asking) store.set({ asking: begun(found) });
      })
      .catch((error) => !gone && setRefused(error.problem ?? null));
    return () => {
      gone = true;
    };
  }, [revision]);
  useEffect(() => {
    if (!form) return;
    let gone = false;
    const timer = setTimeout(() => {
      store.transport
        .ask<Verdict>("plan look", form)
        .then((found) => !gone && setVerdict(found))
        .catch((error) => !gone && setRefused(error.problem ?? null));
    }, PATIENCE);
    return () => {
      gone = true;
      clearTimeout(timer);
    };
  }, [form, revision]);
  if (refused) return <p class="hint">There is nothing to sweep yet: {refused.code} {refused.why}</p>;
  if (!words || !form) return <p class="hint">…</p>;
  const set = (patch: Partial<PlanForm>) => store.set({ asking: { ...store.state.asking!, ...patch } });
  const check = (place: string, make: (text: string) => PlanForm) => (text: string) =>
    store.transport.ask<Verdict>("plan look", make(text)).then((found) => found.wrong[place] ?? null);
  const wrong = verdict?.wrong ?? {};
  const running = state.plan?.state === "running";
  const factor = (k: number, patch: object) => form.factors.map((f, j) => (j === k ? { ...f, ...patch } : f));
  const path = (k: number, text: string) => {
    const bare = text.trim();
    const proposed = words.values[bare];
    const old = form.factors[k];
    const fresh = proposed && (!old.values || old.values === fit(words.values[old.path] ?? "", form.way));
    return factor(k, { path: bare, ...(fresh ? { values: fit(proposed, form.way) } : {}) });
  };
  const way = (next: string) =>
    set({ way: next, count: form.count || "128", factors: form.factors.map((f) => ({ ...f, values: fit(f.values, next) })) });
  const add = () => {
    const free = words.paths.find((p) => p in words.values && !form.factors.some((f) => f.path === p)) ?? "";
    set({ factors: [...form.factors, { path: free, values: fit(words.values[free] ?? "", form.way) }] });
  };
  const many = verdict?.members ?? 0;
  return (
    <section class="plan">
      <h2>What varies</h2>
      {form.factors.map((f, k) => (
        <div class="factor" data-factor={k} key={k}>
          <ExpressionField label={`Factor ${k + 1}`} value={f.path} words={words.paths} placeholder="mu, pad.C, ball.f" onWrite={(text) => set({ factors: path(k, text) })} check={check(`path.${k}`, (text) => ({ ...form, factors: path(k, text) }))} told={wrong[`path.${k}`]} />
          <ExpressionField label={`Values of factor ${k + 1}`} value={f.values} words={["lin(", "log(", "uniform(", "loguniform(", "normal(", "lognormal(", "truncnormal(", "triangular("]} placeholder="0.2:0.3:0.005" onWrite={(text) => set({ factors: factor(k, { values: text.trim() }) })} check={check(`values.${k}`, (text) => ({ ...form, factors: factor(k, { values: text }) }))} told={wrong[`values.${k}`]} />
          <button class="small" aria-label={`Leave out factor ${k + 1}`} disabled={form.factors.length < 2} onClick={() => set({ factors: form.factors.filter((_, j) => j !== k) })}>
            ✕
          </button>
        </div>
      ))}
      <div class="row">
        <button onClick={add}>Add a factor</button>
      </div>
      <details>
        <summary>How values are written</summary>
        <dl>
          <dt>0.2:0.3:0.005</dt>
          <dd>from, to, step</dd>
          <dt>1..2 kg:11, log(1e-4, 1e-2, 50)</dt>
          <dd>so many, evenly or by ratios</dd>
          <dt>1 kg, 1.5 kg</dt>
          <dd>these</dd>
          <dt>1..2 kg, log(1e-4, 1e-2), normal(1 kg, 50 g)</dt>
          <dd>distributions, for samples</dd>
        </dl>
      </details>
      <h2>How members are drawn</h2>
      <label>
        <span>way</span>
        <select aria-label="Way" value={form.way} onChange={(e) => way(e.currentTarget.value)}>
          {Object.keys(words.ways).map((w) => <option value={w}>{NAMES[w] ?? w}</option>)}
        </select>
      </label>
      <p class="hint">{words.ways[form.way]}</p>
      {!WHOLE.includes(form.way) && (
        <label>
          <span>number</span>
          <Field label="Number" value={form.count} onWrite={(text) => set({ count: text.trim() })} />
        </label>
      )}
      {!LEVELS.includes(form.way) && form.way !== "ends" && (
        <label>
          <span>seed</span>
          <Field label="Seed" value={form.seed} onWrite={(text) => set({ seed: text.trim() || "0" })} />
        </label>
      )}
      <Wrong problem={wrong.seed ?? wrong.way} />
      <h2>What is collected</h2>
      <ExpressionField label="Collect" value={form.collect} words={words.words} placeholder="final(x), max(x), count(events), sequence" onWrite={(text) => set({ collect: text.trim() })} check={check("collect", (text) => ({ ...form, collect: text }))} told={wrong.collect} />
      <details>
        <summary>What can be collected</summary>
        <ul>
          {Object.values(words.collectors).map((text) => {
            const [, how, about] = /^(\w+(?:\([^)]*\))?)[:,] (.*)$/.exec(text) ?? ["", text, ""];
            return (
              <li>
                <code>{how}</code> {about}
              </li>
            );
          })}
        </ul>
      </details>
      <label>
        <span>until</span>
        <Field label="Until of the sweep" value={form.until} placeholder={String(state.look!.panels.experiment.until ?? "1 s")} onWrite={(text) => set({ until: text.trim() })} />
      </label>
      <Wrong problem={wrong.until} />
      <div class="row begin">
        {running ? (
          <button class="run" onClick={() => void store.transport.ask("plan cancel").catch(() => {})}>Cancel</button>
        ) : (
          <button class="run" disabled={!many || Object.keys(wrong).length > 0} onClick={() => void store.sweepPlan(store.state.asking!)}>
            ▶ Run {many > 0 ? `${many} members` : "the sweep"}
          </button>
        )}
        {state.plan && !state.planShown && <button onClick={() => store.set({ planShown: true, bottom: true, panel: "" })}>Show the last</button>}
      </div>
      {verdict && Object.values(wrong).every((w) => w.code === LARGE) && (
        <>
          <h2>The same in a terminal</h2>
          <div class="command">
            <code tabindex={0}>{verdict.command}</code>
            <button onClick={() => void navigator.clipboard?.writeText(verdict.command).catch((e) => store.refused(e))}>Copy</button>
          </div>
        </>
      )}
    </section>
  );
}

const NAMES: Record<string, string> = {
  grid: "all combinations",
  together: "side by side",
  random: "at random",
  lhs: "Latin hypercube",
  sobol: "Sobol' sequence",
  saltelli: "for Sobol indices",
  ends: "for a tornado",
};

function Wrong({ problem }: { problem?: Problem }) {
  if (!problem) return null;
  return (
    <small class="wrong" role="status">
      {problem.why} {problem.try && <em>{problem.try}</em>}
    </small>
  );
}

/** The plan that a form begins with: the first parameter, and what tells one run from another. */
function begun(words: PlanWords): PlanForm {
  const path = words.paths.find((p) => p in words.values) ?? words.paths[0] ?? "";
  return { factors: [{ path, values: words.values[path] ?? "" }], way: "grid", count: "128", seed: "0", until: "", collect: words.collect };
}

/** Even levels for a grid, what is between them for a sample: only what was proposed changes. */
function fit(values: string, way: string): string {
  const found = span(values);
  if (!found) return values;
  return LEVELS.includes(way) ? `${found}:11` : found;
}
