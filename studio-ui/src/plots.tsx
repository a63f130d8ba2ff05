/** Plots of a run: one below the other over one time, lanes of modes under them. */
import { Component, createRef } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Curve, Lane, RunSummary, SoFar } from "./messages";
import { PhasePlane } from "./phase";
import { overTime, printed, quantity } from "./quantities";
import type { State, Store } from "./store";

const INKS = ["--c1", "--c2", "--c3", "--c4", "--c5", "--c6"];

interface Props {
  store: Store;
  state: State;
}

interface Shown {
  runs: { run: RunSummary; curves: Curve[] }[];
  strip: Lane[];
}

export function Plots({ store, state }: Props) {
  const [shown, setShown] = useState<Shown | null>(null);
  const [compare, setCompare] = useState(false);
  const [wide, setWide] = useState(800);
  const box = useRef<HTMLDivElement>(null);
  const run = state.run;
  const [t0, t1] = state.span;
  useEffect(() => {
    const e = box.current;
    if (!e) return;
    const watch = new ResizeObserver(() => setWide(Math.max(200, e.clientWidth - 18)));
    watch.observe(e);
    return () => watch.disconnect();
  }, [!run]);
  const names = state.plotted.join("\n");
  useEffect(() => {
    if (!run) return;
    let gone = false;
    const chosen = compare ? state.runs.filter((r) => r.tEnd !== undefined) : [run];
    void Promise.all(
      chosen.map((r) =>
        store.transport
          .ask<{ curves: Curve[]; strip: Lane[] }>("curves", {
            run: r.run,
            names: state.plotted,
            t0,
            t1,
            width: wide,
            strip: r.run === run.run,
          })
          .then((a) => ({ run: r, ...a })),
      ),
    )
      .then((all) => !gone && setShown({ runs: all, strip: all.find((a) => a.run.run === run.run)?.strip ?? [] }))
      .catch((e) => store.refused(e));
    return () => {
      gone = true;
    };
  }, [run?.run, names, t0, t1, wide, compare, state.runs.length]);
  if (state.running && state.soFar) return <Growing state={state} soFar={state.soFar} />;
  if (!run || run.tEnd === undefined)
    return (
      <p class="hint plots">
        {run?.error ? "" : state.running ? "Running …" : "Press Run."} {state.plan && <button onClick={() => store.set({ planShown: true })}>← Sweep</button>}
      </p>
    );
  const cursor = state.cursor?.t ?? null;
  const whole = t0 === run.tBegin && t1 === run.tEnd;
  return (
    <div class="plots" ref={box}>
      <div class="plotbar">
        {state.plan && <button onClick={() => store.set({ planShown: true })}>← Sweep</button>}
        {run.own && <b class="own">{run.title}</b>}
        <Chooser store={store} state={state} run={run} />
        {state.runs.length > 1 && (
          <label>
            <input type="checkbox" checked={compare} onChange={(e) => setCompare(e.currentTarget.checked)} /> compare {state.runs.length} runs
          </label>
        )}
        {!whole && <button onClick={() => store.set({ span: [run.tBegin, run.tEnd] })}>Whole run</button>}
        <label class="scrub">
          <span>t</span>
          <input
            type="range"
            aria-label="Time cursor"
            min={run.tBegin}
            max={run.tEnd}
            step={(run.tEnd - run.tBegin) / 1000 || 1}
            value={cursor ?? run.tBegin}
            onInput={(e) => {
              store.set({ instant: null });
              void store.moveCursor(Number(e.currentTarget.value));
            }}
          />
          <output>{cursor === null ? "" : quantity(cursor, "s")}</output>
        </label>
        <label>
          <input type="checkbox" checked={state.phase} onChange={(e) => store.set({ phase: e.currentTarget.checked })} /> phase plane
        </label>
        <label>
          <input type="checkbox" checked={state.flowing} onChange={(e) => store.set({ flowing: e.currentTarget.checked })} /> power along bonds
        </label>
      </div>
      {run.doubt && <p class="doubt">{run.doubt.said}</p>}
      {state.plotted.map((name, k) => (
        <Trace
          key={name}
          name={name}
          ink={INKS[k % INKS.length]}
          curves={(shown?.runs ?? []).flatMap((r) => r.curves.filter((c) => c.name === name))}
          span={state.span}
          cursor={cursor}
          value={state.cursor?.signals[name] ?? null}
          wide={wide}
          dark={state.dark}
          last={k === state.plotted.length - 1}
          doubt={run.doubt?.t}
          onSpan={(span) => store.set({ span })}
          onTime={(t) => {
            store.set({ instant: null });
            void store.moveCursor(t);
          }}
        />
      ))}
      {state.phase && <PhasePlane store={store} state={state} />}
      <Strip lanes={shown?.strip ?? []} span={state.span} cursor={cursor} onTime={(t) => void store.moveCursor(t)} />
    </div>
  );
}

/** A run that goes on, as far as it is. */
function Growing({ state, soFar }: { state: State; soFar: SoFar }) {
  const box = useRef<HTMLDivElement>(null);
  const span: [number, number] = [soFar.tBegin, soFar.tEnd];
  return (
    <div class="plots" ref={box}>
      {soFar.curves.map((curve, k) => (
        <Trace
          key={curve.name}
          name={curve.name}
          ink={INKS[k % INKS.length]}
          curves={[curve]}
          span={span}
          cursor={null}
          value={null}
          wide={(box.current?.clientWidth ?? 800) - 18}
          dark={state.dark}
          last={k === soFar.curves.length - 1}
          onSpan={() => {}}
          onTime={() => {}}
        />
      ))}
      <Strip lanes={soFar.strip} span={span} cursor={null} onTime={() => {}} />
    </div>
  );
}

function Chooser({ store, state, run }: Props & { run: RunSummary }) {
  const junctions = (state.look?.view.nodes ?? []).flatMap((n) =>
    n.kind === "part" ? [] : [`${n.name}.e`, `${n.name}.f`],
  );
  const offered = [...new Set([...run.names, ...junctions])].filter((n) => !state.plotted.includes(n));
  return (
    <span class="chooser">
      {state.plotted.map((name) => (
        <button class="chip" aria-label={`Do not plot ${name}`} onClick={() => store.set({ plotted: state.plotted.filter((n) => n !== name) })}>
          {name} ✕
        </button>
      ))}
      <input
        aria-label="Plot a signal"
        placeholder="plot …"
        list="signals"
        onKeyDown={(e) => e.stopPropagation()}
        onChange={(e) => {
          const name = e.currentTarget.value.trim();
          if (name) store.set({ plotted: [...state.plotted, name] });
          e.currentTarget.value = "";
        }}
      />
      <datalist id="signals">
        {offered.map((n) => (
          <option value={n} />
        ))}
      </datalist>
    </span>
  );
}

interface TraceProps {
  name: string;
  ink: string;
  curves: Curve[];
  span: [number, number];
  cursor: number | null;
  /** The value at the cursor. */
  value: number | null;
  wide: number;
  dark: boolean | null;
  last: boolean;
  /** From when on its values do not hold. */
  doubt?: number;
  onSpan: (span: [number, number]) => void;
  onTime: (t: number) => void;
}

/** One signal, of one run or of several, with its impulses as arrows. */
class Trace extends Component<TraceProps> {
  box = createRef<HTMLDivElement>();
  private plot: uPlot | null = null;

  componentDidMount(): void {
    this.draw();
  }

  componentDidUpdate(was: TraceProps): void {
    const p = this.props;
    const same =
      was.wide === p.wide && was.dark === p.dark && was.last === p.last && was.doubt === p.doubt &&
      was.curves.length === p.curves.length && was.curves.every((c, k) => c === p.curves[k]);
    if (!same) this.draw();
    else if (was.cursor !== p.cursor) this.plot?.redraw(false);
  }

  componentWillUnmount(): void {
    this.plot?.destroy();
  }

  private draw(): void {
    this.plot?.destroy();
    this.plot = null;
    const { curves, span, wide, last, name } = this.props;
    const box = this.box.current!;
    box.replaceChildren();
    const good = curves.filter((c) => !c.error);
    if (!good.length) return;
    const style = getComputedStyle(box);
    const ink = style.getPropertyValue("--ink");
    const soft = style.getPropertyValue("--line");
    const colours = good.map((_, k) => style.getPropertyValue(k === good.length - 1 ? this.props.ink : INKS[(k + 3) % INKS.length]));
    const tables = good.map((c) => [c.t, c.y] as [number[], (number | null)[]]);
    // at a jump a time stands twice; uPlot.join would merge the two, so one run is not joined
    const data = (tables.length === 1 ? tables[0] : uPlot.join(tables as never)) as uPlot.AlignedData;
    const unit = good[good.length - 1].unit;
    const impulses = good.flatMap((c) => c.impulses);
    this.plot = new uPlot(
      {
        width: Math.max(wide - 4, 200),
        height: last ? 138 : 118,
        // room above for the value at the cursor, which would cover the curve
        padding: [14, 24, 0, 0],
        legend: { show: false },
        cursor: { drag: { x: true, y: false }, points: { show: false } },
        scales: { x: { time: false, range: () => span }, y: { range: (_, low, high) => padded(low, high, impulses.length > 0) } },
        axes: [
          { show: last, stroke: ink, grid: { stroke: soft, width: 1 }, ticks: { stroke: soft }, size: 26, values: (_, v) => ticks(v, "s") },
          { stroke: ink, grid: { stroke: soft, width: 1 }, ticks: { stroke: soft }, size: 74, label: name, labelSize: 18, labelFont: "11px sans-serif", font: "10px sans-serif", values: (_, v) => ticks(v, unit) },
        ],
        series: [{}, ...good.map((_, k) => ({ stroke: colours[k], width: 1.5, points: { show: false }, pxAlign: 0, spanGaps: tables.length > 1 }))],
        hooks: {
          drawClear: [(u) => this.doubted(u, style.getPropertyValue("--doubt"))],
          draw: [
            (u) => {
              this.arrows(u, impulses, colours[colours.length - 1], unit);
              this.timeline(u, ink);
            },
          ],
          setSelect: [
            (u) => {
              if (u.select.width < 4) return;
              this.props.onSpan([u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]);
            },
          ],
        },
      },
      data,
      box,
    );
    const over = this.plot.over;
    let pressed = 0;
    over.addEventListener("mousedown", (e) => (pressed = e.clientX));
    over.addEventListener("click", (e) => {
      if (Math.abs(e.clientX - pressed) < 4 && this.plot) this.props.onTime(this.plot.posToVal(e.offsetX, "x"));
    });
    over.addEventListener("dblclick", () => this.props.onSpan([good[0].t[0], good[0].t[good[0].t.length - 1]]));
  }

  /** Impulses as arrows from zero with their areas, as in printed plots. */
  private arrows(u: uPlot, impulses: [number, number][], colour: string, unit: string): void {
    if (!impulses.length) return;
    const most = Math.max(...impulses.map(([, a]) => Math.abs(a)));
    const { left, top, width, height } = u.bbox;
    const zero = Math.min(Math.max(u.valToPos(0, "y", true), top), top + height);
    const c = u.ctx;
    const px = devicePixelRatio;
    c.save();
    c.strokeStyle = c.fillStyle = colour;
    c.lineWidth = 1.5 * px;
    c.font = `${10 * px}px sans-serif`;
    for (const [t, area] of impulses) {
      const x = u.valToPos(t, "x", true);
      if (x < left || x > left + width) continue;
      const tip = zero - Math.sign(area) * (0.25 + (0.3 * Math.abs(area)) / most) * height;
      const end = Math.min(Math.max(tip, top + 6 * px), top + height - 6 * px);
      const sign = Math.sign(end - zero) || 1;
      c.beginPath();
      c.moveTo(x, zero);
      c.lineTo(x, end);
      c.moveTo(x - 4 * px, end - 7 * px * sign);
      c.lineTo(x, end);
      c.lineTo(x + 4 * px, end - 7 * px * sign);
      c.stroke();
      if (impulses.length <= 12) {
        const words = `${quantity(area, overTime(unit))} δ`;
        const room = x + 8 * px + c.measureText(words).width < left + width;
        c.textAlign = room ? "left" : "right";
        c.fillText(words, x + (room ? 6 : -6) * px, (zero + end) / 2);
      }
    }
    c.restore();
  }

  /** A shade and a line where values end to hold, as in printed plots. */
  private doubted(u: uPlot, colour: string): void {
    const t = this.props.doubt;
    if (t === undefined) return;
    const { left, top, width, height } = u.bbox;
    const x = Math.max(u.valToPos(t, "x", true), left);
    if (x > left + width) return;
    const c = u.ctx;
    c.save();
    c.fillStyle = c.strokeStyle = colour;
    c.globalAlpha = 0.12;
    c.fillRect(x, top, left + width - x, height);
    c.globalAlpha = 1;
    c.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
    c.beginPath();
    c.moveTo(x, top);
    c.lineTo(x, top + height);
    c.stroke();
    c.restore();
  }

  private timeline(u: uPlot, colour: string): void {
    const t = this.props.cursor;
    if (t === null) return;
    const x = u.valToPos(t, "x", true);
    const { left, top, width, height } = u.bbox;
    if (x < left || x > left + width) return;
    u.ctx.save();
    u.ctx.strokeStyle = colour;
    u.ctx.setLineDash([4, 3]);
    u.ctx.beginPath();
    u.ctx.moveTo(x, top);
    u.ctx.lineTo(x, top + height);
    u.ctx.stroke();
    u.ctx.restore();
  }

  render({ name, curves, value, cursor }: TraceProps) {
    const failed = curves.find((c) => c.error);
    return (
      <figure class="trace" aria-label={`Plot of ${name}`}>
        <div ref={this.box} />
        {cursor !== null && <output class="reading">{quantity(value, curves.find((c) => !c.error)?.unit ?? "")}</output>}
        {failed && <p class="hint">{failed.error!.code} {failed.error!.why}</p>}
      </figure>
    );
  }
}

/** Room above and below; zero is in sight where impulses stand on it. */
function padded(low: number | null, high: number | null, zero: boolean): [number, number] {
  let [a, b] = [low ?? 0, high ?? 1];
  if (zero) [a, b] = [Math.min(a, 0), Math.max(b, 0)];
  const room = 0.08 * (b - a) || 0.1 * Math.abs(a) || 1;
  return [a - room, b + room];
}

function ticks(values: number[], unit: string): string[] {
  const most = Math.max(...values.map(Math.abs));
  const scale = ([1e9, 1e6, 1e3, 1, 1e-3, 1e-6, 1e-9] as number[]).find((f) => most >= f) ?? 1e-12;
  const prefix = { 1e9: "G", 1e6: "M", 1e3: "k", 1: "", 1e-3: "m", 1e-6: "µ", 1e-9: "n", 1e-12: "p" }[scale] ?? "";
  const simple = /^[A-Za-zΩ]+$/.test(unit) && unit !== "kg";
  return values.map((v) => (simple ? `${+(v / scale).toPrecision(5)} ${prefix}${unit}` : `${+v.toPrecision(5)} ${printed(unit)}`));
}

const FILLS = ["var(--s0)", "var(--s1)", "var(--s2)", "var(--s3)", "var(--s4)", "var(--s5)", "var(--s6)", "var(--s7)"];

/** One lane per machine; where a pixel holds many stays, how opaque a state is says its share. */
function Strip({ lanes, span: [t0, t1], cursor, onTime }: { lanes: Lane[]; span: [number, number]; cursor: number | null; onTime: (t: number) => void }) {
  if (!lanes.length) return null;
  const high = 18;
  const x = (t: number) => (1000 * (t - t0)) / (t1 - t0 || 1);
  return (
    <div class="strip">
      <div class="stripnames" aria-hidden="true">
        {lanes.map((l) => <span title={l.machine}>{l.machine}</span>)}
      </div>
      <svg
        viewBox={`0 0 1000 ${high * lanes.length}`}
        preserveAspectRatio="none"
        style={{ height: `${high * lanes.length}px` }}
        role="img"
        aria-label={`Modes: ${lanes.map((l) => `${l.machine} is ${l.stays?.map(([, , k]) => l.states[k]).slice(0, 12).join(", ") ?? "switching fast"}`).join("; ")}`}
        onClick={(e) => {
          const r = e.currentTarget.getBoundingClientRect();
          onTime(t0 + ((e.clientX - r.left) / r.width) * (t1 - t0));
        }}
      >
        {lanes.map((lane, row) => (
          <g transform={`translate(0,${row * high})`}>
            {lane.stays?.map(([a, b, k]) => (
              <rect x={x(Math.max(a, t0))} width={Math.max(0.7, x(Math.min(b, t1)) - x(Math.max(a, t0)))} y={1} height={high - 2} fill={FILLS[k % FILLS.length]}>
                <title>{lane.states[k]}</title>
              </rect>
            ))}
            {lane.shares?.map((share, k) =>
              share.map((part, j) =>
                part > 0 ? <rect x={(1000 * j) / share.length} width={1000 / share.length} y={1} height={high - 2} fill={FILLS[k % FILLS.length]} opacity={part} /> : null,
              ),
            )}
          </g>
        ))}
        {cursor !== null && cursor >= t0 && cursor <= t1 && <line class="now" x1={x(cursor)} x2={x(cursor)} y1={0} y2={high * lanes.length} />}
      </svg>
      <div class="stripwords" aria-hidden="true">
        {lanes.map((lane, row) =>
          lane.stays
            ?.filter(([a, b]) => x(Math.min(b, t1)) - x(Math.max(a, t0)) > 60)
            .map(([a, b, k]) => (
              <span style={{ left: `${(x(Math.max(a, t0)) + x(Math.min(b, t1))) / 20}%`, top: `${row * high}px` }}>{lane.states[k]}</span>
            )),
        )}
      </div>
    </div>
  );
}
