/** All that the page knows, and what can be done with it. No drawing here. */
import type { Choice, Cursor, GraphNode, Instant, Look, Place, Problem, RunSummary, Member, PlanForm, PlanNow, SoFar, Stock, Swept } from "./messages";
import { CELL, partFrame } from "./shapes";
import { shared } from "./sharing";
import { Refused, type Transport } from "./transport";

export type Tab = "item" | "machines" | "model" | "problems" | "table" | "text" | "equations" | "power" | "plan";

export interface State {
  connected: boolean;
  look: Look | null;
  stock: Stock | null;
  level: string;
  mode: Record<string, string> | null;
  nodes: Set<string>;
  bonds: Set<string>;
  tab: Tab;
  /** The node from which a bond is being drawn with the keyboard. */
  bondFrom: string | null;
  drawing: boolean;
  notice: Problem | null;
  run: RunSummary | null;
  runs: RunSummary[];
  running: { run: number; t: number; events: number } | null;
  sweep: Swept | null;
  /** The plan of many runs that is being written, and the sweep of one that runs or has ended. */
  asking: PlanForm | null;
  plan: PlanNow | null;
  /** Whether its views are shown below, in place of plots. */
  planShown: boolean;
  /** Which of its views, and which run is chosen; null before anything is. */
  looked: { plan: number; choice: Choice; chosen: number | null } | null;
  /** The plots of a run that goes on. */
  soFar: SoFar | null;
  cursor: Cursor | null;
  instant: { event: Instant; step: number } | null;
  plotted: string[];
  span: [number, number];
  adding: boolean;
  /** Whether a name is looked for. */
  finding: boolean;
  /** How often the graph was laid out anew. */
  arranged: number;
  bottom: boolean;
  panel: "" | "palette" | "side";
  dark: boolean | null;
  flowing: boolean;
  /** Whether the second plotted signal is drawn over the first, too. */
  phase: boolean;
  /** Whether the schematic stands beside the bond graph. */
  schematic: boolean;
  /** Width of the panels and height of the plots, pixels. */
  room: { side: number; low: number };
}

const BEGIN: State = {
  connected: false,
  look: null,
  stock: null,
  level: "",
  mode: null,
  nodes: new Set(),
  bonds: new Set(),
  tab: "item",
  bondFrom: null,
  drawing: false,
  notice: null,
  run: null,
  runs: [],
  running: null,
  soFar: null,
  sweep: null,
  asking: null,
  plan: null,
  planShown: false,
  looked: null,
  cursor: null,
  instant: null,
  plotted: [],
  span: [0, 1],
  adding: false,
  finding: false,
  arranged: 0,
  bottom: false,
  panel: "",
  dark: null,
  flowing: false,
  phase: false,
  schematic: false,
  room: { side: 340, low: 0 },
};

const ONE_PORTS = ["C", "I", "R", "G", "Se", "Sf"];

/** Half the width of a part that is not yet there, in cells. */
const PART = 0.9;

/** Half the width of a node, in cells. */
function broad(node: GraphNode): number {
  const ports = node.ports ?? [];
  return ports.length ? partFrame(node, ports.map((_, k) => "we"[k % 2]).join("")).half / CELL[0] : 0.3;
}

/** Signals that are plotted at once; the same number in studio/curves.py. */
const MOST_PLOTTED = 32;

export class Store {
  state: State = BEGIN;
  private listeners = new Set<() => void>();
  private queue: Promise<unknown> = Promise.resolve();

  constructor(readonly transport: Transport) {
    transport.onTold = (m) => this.told(m);
  }

  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  set(patch: Partial<State>): void {
    this.state = { ...this.state, ...patch };
    for (const listener of this.listeners) listener();
  }

  // -- what the session answers

  async begin(): Promise<void> {
    this.set({ connected: true });
    await this.look();
    if (!this.state.stock) this.set({ stock: await this.transport.ask<Stock>("stock") });
    const { runs } = await this.transport.ask<{ runs: RunSummary[] }>("runs");
    this.set({ runs });
    const last = runs[runs.length - 1];
    if (last && !this.state.run) this.show(last);
    const { now } = await this.transport.ask<{ now: PlanNow | null }>("plan state");
    this.set({ plan: now });
  }

  private where() {
    return { level: this.state.level, mode: this.state.mode };
  }

  async look(): Promise<void> {
    await this.taking(this.transport.ask<Look>("look", this.where()));
  }

  /** Wait for an answer and show it; what is refused is noticed. Answers come in order. */
  private async taking(asked: Promise<Look>): Promise<Look | null> {
    try {
      const look = await asked;
      this.take(look);
      return look;
    } catch (error) {
      this.refused(error);
      return null;
    }
  }

  refused(error: unknown): void {
    if (error instanceof Refused) this.set({ notice: error.problem });
    else if (this.state.connected)
      this.set({ notice: { code: "", where: "", why: String(error), try: "" } });
  }

  private take(answer: Look): void {
    const look = shared(this.state.look, answer);
    const names = new Set(look.view.nodes.map((n) => n.name));
    const keys = new Set(look.view.bonds.map((b) => b.key));
    this.set({
      look,
      level: look.view.path,
      nodes: new Set([...this.state.nodes].filter((n) => names.has(n))),
      bonds: new Set([...this.state.bonds].filter((b) => keys.has(b))),
      bondFrom: this.state.bondFrom && names.has(this.state.bondFrom) ? this.state.bondFrom : null,
    });
  }

  private told(message: Record<string, unknown>): void {
    if (message.tell === "changed") {
      const mine = message.by === this.transport.client;
      if (!mine && message.revision !== this.state.look?.revision) void this.look();
    } else if (message.tell === "progress") {
      this.set({ running: message as never });
    } else if (message.tell === "sweeping") {
      this.set({ sweep: { ...(message as unknown as Swept), members: [], done: false }, planShown: false, bottom: true });
    } else if (message.tell === "member" || message.tell === "swept") {
      const { sweep } = this.state;
      if (sweep?.sweep !== message.sweep || !sweep) return;
      const members = [...sweep.members];
      if (message.tell === "member") members[message.member as number] = message as unknown as Member;
      this.set({ sweep: { ...sweep, members, done: message.tell === "swept" } });
    } else if (message.tell === "planning") {
      const { plan } = this.state;
      if (plan?.plan === message.plan) this.set({ plan: { ...plan, ...(message as unknown as PlanNow) } });
    } else if (message.tell === "partial") {
      this.set({ soFar: message as never });
    } else if (message.tell === "finished") {
      const run = message as unknown as RunSummary;
      this.set({ running: null, soFar: null, runs: [...this.state.runs.filter((r) => r.run !== run.run), run] });
      this.show(run);
      if (run.error) this.set({ notice: run.error });
    } else if (message.tell === "saved" && this.state.look) {
      this.set({ look: { ...this.state.look, unsaved: String(message.unsaved) } });
    }
  }

  show(run: RunSummary): void {
    // efforts and flows of junctions are no names of the run, and stay what was chosen
    const nodes = new Set((this.state.look?.view.nodes ?? []).map((n) => n.name));
    const known = this.state.plotted.some((n) => run.names?.includes(n) || nodes.has(n.replace(/\.[ef]$/, "")));
    this.set({
      run,
      plotted: known ? this.state.plotted : (run.plot ?? []).slice(0, MOST_PLOTTED),
      span: [run.tBegin ?? 0, run.tEnd ?? 1],
      cursor: null,
      instant: null,
      bottom: true,
    });
  }

  // -- edits

  /** Do one edit; edits wait for each other so that none is lost. */
  edit(edit: Record<string, unknown>): Promise<Look | null> {
    const asked = this.queue.then(() =>
      this.taking(
        this.transport.ask<Look>("edit", {
          ...this.where(),
          edit: { level: this.state.level, ...edit },
        }),
      ),
    );
    this.queue = asked;
    this.set({ cursor: null, instant: null });
    return asked;
  }

  ask(question: string, more: object = {}): Promise<Look | null> {
    const asked = this.queue.then(() =>
      this.taking(this.transport.ask<Look>(question, { ...this.where(), ...more })),
    );
    this.queue = asked;
    return asked;
  }

  undo = () => this.ask("undo");
  redo = () => this.ask("redo");

  /** Lay out anew, and show all of it; selected elements stay where they are. */
  async arrange(): Promise<void> {
    if (await this.ask("arrange", { keep: [...this.state.nodes] })) this.set({ arranged: this.state.arranged + 1 });
  }

  async add(element: object, stem: string, at?: [number, number]): Promise<void> {
    const before = new Set(this.state.look?.view.nodes.map((n) => n.name));
    const place = at ?? this.freePlace(element);
    const look = await this.edit({ do: "add", element, stem, at: place });
    const made = look?.view.nodes.find((n) => !before.has(n.name));
    if (made) this.set({ nodes: new Set([made.name]), bonds: new Set(), tab: "item" });
  }

  /**
   * A place where nothing stands, as a layout has it: inner nodes go on to the right of what is selected, or of
   * the last node; one-ports hang above and below an inner node, sources stand at its left.
   */
  freePlace(element: object): [number, number] {
    const nodes = this.state.look?.view.nodes ?? [];
    if (!nodes.length) return [0, 0];
    const kind = ONE_PORTS.find((k) => k in element);
    const last = nodes.findIndex((n) => this.state.nodes.has(n.name));
    const begun = nodes.slice(0, last < 0 ? nodes.length : last + 1);
    const inner = begun.filter((n) => !ONE_PORTS.includes(n.kind));
    const chosen = inner[inner.length - 1] ?? begun[begun.length - 1];
    const part = "submodel" in element;
    const taken = (x: number, y: number) =>
      nodes.some((n) => Math.abs(n.x - x) < broad(n) + (part ? PART : 0.3) && Math.abs(n.y - y) < (n.ports?.length || part ? 0.9 : 0.6));
    const x0 = Math.round(chosen.x);
    const y0 = Math.round(chosen.y);
    const west: [number, number][] = kind?.startsWith("S") ? [[-1, 0]] : [];
    const hung: [number, number][] = kind && inner.length ? [...west, [0, -1], [0, 1]] : [];
    const along: [number, number][] = part || broad(chosen) > 0.3 ? [[1, 0], [2, 0], [3, 0], [4, 0]] : [];
    const near: [number, number][] = [...hung, ...along, [1, 0], [0, -1], [0, 1], [-1, 0], [1, -1], [1, 1], [2, 0]];
    for (const [dx, dy] of near) if (!taken(x0 + dx, y0 + dy)) return [x0 + dx, y0 + dy];
    for (let x = 3; ; x++) if (!taken(x0 + x, y0)) return [x0 + x, y0];
  }

  async bond(tail: string, head: string): Promise<void> {
    const before = new Set(this.state.look?.view.bonds.map((b) => b.key));
    const look = await this.edit({ do: "bond", tail, head });
    const made = look?.view.bonds.find((b) => !before.has(b.key));
    if (made) this.set({ bonds: new Set([made.key]), nodes: new Set() });
    this.set({ bondFrom: null });
  }

  remove(): void {
    const { nodes, bonds } = this.state;
    if (nodes.size || bonds.size) void this.edit({ do: "remove", names: [...nodes], bonds: [...bonds] });
  }

  reverse(): void {
    if (this.state.bonds.size) void this.edit({ do: "reverse", bonds: [...this.state.bonds] });
  }

  async copy(): Promise<string> {
    const names = [...this.state.nodes];
    if (!names.length) return "";
    const { text } = await this.transport.ask<{ text: string }>("copy", { ...this.where(), names });
    return text;
  }

  async duplicate(): Promise<void> {
    const text = await this.copy();
    if (text) await this.paste(text);
  }

  async paste(text: string): Promise<void> {
    const look = await this.ask("paste", { text, by: [1, 1] });
    if (look?.pasted) this.set({ nodes: new Set(look.pasted), bonds: new Set() });
  }

  // -- where we are

  open(path: string): void {
    this.set({ level: path, nodes: new Set(), bonds: new Set(), cursor: null, instant: null });
    void this.look();
  }

  setMode(machine: string, state: string): void {
    const now = Object.fromEntries((this.state.look?.machines ?? []).map((m) => [m.path, m.state]));
    this.set({ mode: { ...now, [machine]: state }, cursor: null, instant: null });
    void this.look();
  }

  select(place: Place | undefined): void {
    if (!place) return;
    this.set({ nodes: new Set(place.nodes ?? []), bonds: new Set(place.bonds ?? []) });
    if (place.entry?.[0] === "machines") this.set({ tab: "machines" });
    else if (place.entry) this.set({ tab: "model" });
  }

  // -- runs

  async start(until?: string): Promise<void> {
    try {
      const { run } = await this.transport.ask<{ run: number }>("run", {
        ...(until ? { until } : {}),
        names: this.state.plotted,
      });
      if (!this.state.runs.some((r) => r.run === run))
        this.set({ running: { run, t: 0, events: 0 }, soFar: null, sweep: null, planShown: false, bottom: true });
    } catch (error) {
      this.refused(error);
    }
  }

  /** Run all members of the plan that is written. */
  async sweepPlan(form: PlanForm): Promise<void> {
    try {
      const plan = await this.transport.ask<PlanNow>("plan begin", form);
      this.set({ plan, planShown: true, bottom: true, panel: "" });
    } catch (error) {
      this.refused(error);
    }
  }

  /** Run one member of the sweep by itself, and plot it. */
  async openMember(member: number): Promise<void> {
    try {
      const { run } = await this.transport.ask<{ run: number }>("plan open", { plan: this.state.plan?.plan, member, names: this.state.plotted });
      if (!this.state.runs.some((r) => r.run === run)) this.set({ running: { run, t: 0, events: 0 }, soFar: null });
      this.set({ sweep: null, planShown: false, bottom: true });
    } catch (error) {
      this.refused(error);
    }
  }

  /** Run the model with a parameter over a range; whether that began. */
  async sweep(range: { path: string; from: string; to: string; count: string; log: boolean }): Promise<boolean> {
    try {
      await this.transport.ask("sweep", { ...range, names: this.state.plotted });
      return true;
    } catch (error) {
      this.refused(error);
      return false;
    }
  }

  cancel = () => void this.transport.ask("cancel").catch(() => {});

  private cursorCount = 0;

  async moveCursor(t: number, side: "left" | "right" = "right", mode?: Record<string, string>) {
    const run = this.state.run;
    if (!run) return;
    const count = ++this.cursorCount;
    try {
      const cursor = await this.transport.ask<Cursor>("cursor", {
        run: run.run,
        t,
        side,
        mode: mode ?? null,
        level: this.state.level,
        names: this.state.plotted,
      });
      const strokes = shared(this.state.cursor?.strokes ?? this.state.look?.strokes, cursor.strokes);
      if (count === this.cursorCount) this.set({ cursor: { ...cursor, strokes } });
    } catch (error) {
      this.refused(error);
    }
  }

  showInstant(event: Instant, step: number): void {
    this.set({ instant: { event, step } });
    void this.moveCursor(event.t, step < event.steps.length - 1 ? "left" : "right", event.steps[step].mode);
  }
}
