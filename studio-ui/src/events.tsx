/** The events of a run and why each happened; a click shows the instant on the canvas. */
import { useEffect, useState } from "preact/hooks";
import type { Instant } from "./messages";
import { number, quantity } from "./quantities";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

const PAGE = 100;

export function Events({ store, state }: Props) {
  const [found, setFound] = useState<Instant[]>([]);
  const [total, setTotal] = useState(0);
  const [first, setFirst] = useState(0);
  const run = state.run;
  useEffect(() => setFirst(0), [run?.run]);
  useEffect(() => {
    if (!run || run.tEnd === undefined) return setFound([]);
    let gone = false;
    void store.transport
      .ask<{ events: Instant[]; total: number }>("events", { run: run.run, first, count: PAGE })
      .then((a) => {
        if (gone) return;
        setFound(a.events);
        setTotal(a.total);
      })
      .catch((e) => store.refused(e));
    return () => {
      gone = true;
    };
  }, [run?.run, first]);
  const open = state.instant?.event.event;
  return (
    <section class="events" tabindex={0} aria-label="Events">
      {run && run.tEnd !== undefined && (
        <p class={"status " + run.status}>
          {run.status === "ok" ? "ok" : <b>{run.status}</b>}, {total} events, {quantity(run.took, "s")}
          {run.method ? `, ${run.method}` : ""}
        </p>
      )}
      {run?.warnings?.map((w) => <p class="warning">{w}</p>)}
      {total > PAGE && (
        <p>
          <button disabled={first === 0} onClick={() => setFirst(Math.max(0, first - PAGE))}>◂</button> {first + 1} to {Math.min(first + PAGE, total)} of {total}{" "}
          <button disabled={first + PAGE >= total} onClick={() => setFirst(first + PAGE)}>▸</button>
        </p>
      )}
      <ol>
        {found.map((e) => (
          <li class={e.event === open ? "open" : ""}>
            <button data-event={e.event} aria-expanded={e.event === open} onClick={() => store.showInstant(e, 0)}>
              <b>{quantity(e.t, "s")}</b> <i>{e.cause}</i>{" "}
              {e.steps.flatMap((s) => s.fired).map((f) => `${f.machine}: ${f.source} → ${f.target}`).join("; ")}
              {e.steps.some((s) => s.kind !== "continuous") && <em> {kinds(e)}</em>}
            </button>
            {e.event === open && <Detail store={store} state={state} event={e} />}
          </li>
        ))}
      </ol>
    </section>
  );
}

function kinds(e: Instant): string {
  const count = (kind: string) => e.steps.filter((s) => s.kind === kind).length;
  return [
    [count("mythical"), "mythical"],
    [count("pinnacle"), "pinnacle"],
  ]
    .filter(([n]) => n)
    .map(([n, kind]) => (n === 1 ? kind : `${n} ${kind}`))
    .join(", ");
}

function Detail({ store, state, event }: Props & { event: Instant }) {
  const at = state.instant!.step;
  const step = event.steps[at];
  return (
    <div class="detail">
      <div class="row">
        {event.steps.map((s, k) => (
          <button class={"stepbutton " + s.kind} aria-pressed={k === at} data-step={k} onClick={() => store.showInstant(event, k)}>
            {k + 1}. {s.kind}
          </button>
        ))}
      </div>
      <p>
        mode: {Object.entries(step.mode).map(([m, s]) => `${m} = ${s}`).join(", ") || "the only one"}
        {step.kind === "mythical" && " (lasts no time, stores nothing)"}
        {step.kind === "pinnacle" && " (lasts no time, writes the state)"}
      </p>
      {step.fired.map((f) => (
        <p class="fired">
          <b>{f.machine}</b>: {f.source} → {f.target}, because <code>{f.why}</code>
        </p>
      ))}
      {Object.keys(step.impulses).length > 0 && (
        <p>
          impulses{step.kind === "mythical" ? " (on trial)" : ""}:{" "}
          {Object.entries(step.impulses).map(([name, area]) => `${name} = ${number(area, 6)} δ`).join(", ")}
        </p>
      )}
      {step.energy && (
        <p>
          energy {step.energy.before} → {step.energy.after}; supplied {step.energy.source}, lost {step.energy.lost}
        </p>
      )}
      {step.undetermined.length > 0 && <p>not determined: {step.undetermined.join(", ")}</p>}
    </div>
  );
}
