/** The page: what stands where. */
import { Component } from "preact";
import { Canvas } from "./canvas";
import { Events } from "./events";
import { Find } from "./find";
import { Equations } from "./formulas";
import { Item } from "./item";
import { Machines } from "./machines";
import { ModelPanel, Problems, TableView, TextPanel } from "./panels";
import { Palette, QuickAdd } from "./palette";
import { PlanPanel } from "./plan";
import { PlanView } from "./planned";
import { Plots } from "./plots";
import { Power } from "./power";
import { quantity } from "./quantities";
import { Splitter } from "./splitter";
import { Schematic } from "./schematic";
import type { State, Store, Tab } from "./store";
import { SweepView } from "./sweeps";

const TABS: [Tab, string][] = [
  ["item", "Properties"],
  ["machines", "Machines"],
  ["model", "Model"],
  ["problems", "Problems"],
  ["table", "Table"],
  ["text", "Text"],
  ["equations", "Equations"],
  ["power", "Power"],
  ["plan", "Sweep"],
];

export class App extends Component<{ store: Store; whole?: boolean }, State> {
  state = this.props.store.state;
  private stop = () => {};

  componentDidMount(): void {
    this.stop = this.props.store.subscribe(() => this.setState(this.props.store.state));
    this.setState(this.props.store.state);
    document.addEventListener("copy", this.copy);
    document.addEventListener("cut", this.copy);
    document.addEventListener("paste", this.paste);
    document.addEventListener("keydown", this.key);
  }

  componentWillUnmount(): void {
    this.stop();
    document.removeEventListener("copy", this.copy);
    document.removeEventListener("cut", this.copy);
    document.removeEventListener("paste", this.paste);
    document.removeEventListener("keydown", this.key);
  }

  private onCanvas(): boolean {
    const at = document.activeElement;
    return !!at?.closest?.(".studio") && !/^(INPUT|TEXTAREA|SELECT)$/.test(at.tagName);
  }

  private held = "";

  private copy = (e: ClipboardEvent): void => {
    if (!this.onCanvas() || String(getSelection() ?? "")) return;
    const { store } = this.props;
    if (!store.state.nodes.size) return;
    e.preventDefault();
    const cut = e.type === "cut";
    void store.copy().then((text) => {
      this.held = text;
      void navigator.clipboard?.writeText(text).catch(() => {});
      if (cut) store.remove();
    });
  };

  private paste = (e: ClipboardEvent): void => {
    if (!this.onCanvas()) return;
    const text = e.clipboardData?.getData("text/plain") || this.held;
    if (!text.includes("elements")) return;
    e.preventDefault();
    void this.props.store.paste(text);
  };

  private key = (e: KeyboardEvent): void => {
    const ctrl = e.ctrlKey || e.metaKey;
    const { store, whole } = this.props;
    if (whole && document.activeElement === document.body && e.key !== "Tab") {
      // the document is this page, and nothing in it has the focus: keys are for the picture
      const svg = document.querySelector<SVGSVGElement>(".canvas svg");
      svg?.focus({ preventScroll: true });
      if (svg && !svg.dispatchEvent(new KeyboardEvent(e.type, e))) e.preventDefault();
      return;
    }
    if (!ctrl || !this.onCanvas()) return;
    const key = e.key.toLowerCase();
    if (key === "z" && !e.shiftKey) void store.undo();
    else if (key === "y" || (key === "z" && e.shiftKey)) void store.redo();
    else if (key === "s") void 0; // it is saved with each edit
    else if (key === "enter") void store.start();
    else return;
    e.preventDefault();
  };

  render({ store }: { store: Store }, state: State) {
    const look = state.look;
    if (!look) return <div class="studio loading" role="status">{state.connected ? "Opening …" : "Connecting …"}</div>;
    const theme = state.dark === null ? "" : state.dark ? " dark" : " light";
    const errors = look.problems.filter((p) => p.grave === "error").length;
    const hints = look.problems.length - errors;
    const one = [...state.nodes, ...[...state.bonds].map((k) => look.view.bonds.find((b) => b.key === k)?.text)].join(", ");
    return (
      <main class={"studio" + theme + (state.bottom ? " withbottom" : "")} style={`--side: ${state.room.side}px; --low: ${state.room.low ? `${state.room.low}px` : "44%"}`}>
        <Header store={store} state={state} errors={errors} />
        <div class="middle">
          <Palette store={store} state={state} />
          <div class={"canvases" + (state.schematic ? " two" : "")}>
            <Canvas store={store} state={state} />
            {state.schematic && <Schematic store={store} state={state} />}
          </div>
          <Splitter upright label="Width of the panels" value={state.room.side} least={220} most={900} sign={-1} onChange={(side) => store.set({ room: { ...state.room, side } })} />
          <aside class={"side" + (state.panel === "side" ? " open" : "")} aria-label="Panels">
            <div class="tabs" role="tablist" aria-label="Panels">
              {TABS.map(([tab, word]) => (
                <button role="tab" id={`tab-${tab}`} aria-controls="panel" aria-selected={state.tab === tab} onClick={() => store.set({ tab })}>
                  {word}
                  {tab === "problems" && look.problems.length > 0 && <span class={"count" + (errors ? " error" : "")}>{look.problems.length}</span>}
                </button>
              ))}
            </div>
            <div class="panel" id="panel" role="tabpanel" aria-labelledby={`tab-${state.tab}`} tabindex={0}>
              {state.tab === "item" && <Item store={store} state={state} />}
              {state.tab === "machines" && <Machines store={store} state={state} />}
              {state.tab === "model" && <ModelPanel store={store} state={state} />}
              {state.tab === "problems" && <Problems store={store} state={state} />}
              {state.tab === "table" && <TableView store={store} state={state} />}
              {state.tab === "text" && <TextPanel store={store} state={state} />}
              {state.tab === "equations" && <Equations store={store} state={state} />}
              {state.tab === "power" && <Power store={store} state={state} />}
              {state.tab === "plan" && <PlanPanel store={store} state={state} />}
            </div>
          </aside>
        </div>
        {state.bottom && (
          <div class="bottom">
            <Splitter upright={false} label="Height of the plots" value={state.room.low || 320} least={120} most={900} sign={-1} onChange={(low) => store.set({ room: { ...state.room, low } })} />
            {state.planShown && state.plan ? (
              <PlanView store={store} state={state} plan={state.plan} />
            ) : (
              <>
                {state.sweep ? <SweepView store={store} state={state} /> : <Plots store={store} state={state} />}
                <Events store={store} state={state} />
              </>
            )}
          </div>
        )}
        <footer>
          <span id="chosen" role="status" aria-live="polite">
            {one || (look.whole ? "" : "strokes of what is joined so far")}
          </span>
          <Modes store={store} state={state} />
          <button class={"verdict" + (errors ? " error" : hints ? " hint" : "")} onClick={() => store.set({ tab: "problems", panel: "side" })}>
            {errors ? `${errors} ${errors === 1 ? "problem" : "problems"}: ${look.problems[0].code} ${look.problems[0].where}` : hints ? `${hints} hint${hints > 1 ? "s" : ""}` : "fine"}
          </button>
          <button class="verdict" aria-pressed={state.bottom} onClick={() => store.set({ bottom: !state.bottom })}>plots</button>
        </footer>
        {state.adding && look.view.editable && <QuickAdd store={store} state={state} />}
        {state.finding && <Find store={store} state={state} />}
        {state.notice && (
          <div class="notice" role="alert">
            <b>{state.notice.code}</b> {state.notice.where && <i>{state.notice.where}: </i>}
            {state.notice.why}
            {state.notice.try && <em> Try: {state.notice.try}</em>}
            <button aria-label="Close this message" onClick={() => store.set({ notice: null })}>✕</button>
          </div>
        )}
        {!state.connected && <div class="notice" role="alert">The studio does not answer. What you did is in the file; trying again …</div>}
      </main>
    );
  }
}

/** The mode that is drawn: each machine with its states to choose. */
function Modes({ store, state }: { store: Store; state: State }) {
  const look = state.look!;
  const own = look.machines;
  const shown = state.cursor?.mode;
  if (!own.length) return null;
  return (
    <span class="modes">
      {state.cursor && <b>t = {quantity(state.cursor.t, "s", 6)}</b>}
      {own.slice(0, 8).map((m) => (
        <label>
          {m.path}
          <select aria-label={`State of ${m.path} that is drawn`} value={shown?.[m.path] ?? m.state} onChange={(e) => store.setMode(m.path, e.currentTarget.value)}>
            {m.states.map((s) => <option>{s}</option>)}
          </select>
        </label>
      ))}
      {own.length > 8 && `and ${own.length - 8} more`}
    </span>
  );
}

function Header({ store, state, errors }: { store: Store; state: State; errors: number }) {
  const look = state.look!;
  const running = state.running;
  const until = Number(look.panels.experiment.until) || state.run?.until || 1;
  return (
    <header>
      <Menu store={store} state={state} />
      <h1 title={look.file}>{look.title || look.file}</h1>
      <span class={"saved" + (look.unsaved ? " error" : "")} role="status">
        {look.unsaved ? `not saved: ${look.unsaved}` : look.inMemory ? "in memory" : look.writable ? "saved" : "read only: open in another studio"}
      </span>
      <span class="spring" />
      <button class="narrow" aria-label="Palette" aria-pressed={state.panel === "palette"} onClick={() => store.set({ panel: state.panel === "palette" ? "" : "palette" })}>+</button>
      <button class="narrow" aria-label="Panels" aria-pressed={state.panel === "side"} onClick={() => store.set({ panel: state.panel === "side" ? "" : "side" })}>☰</button>
      <button title="Undo (Ctrl+Z)" aria-label="Undo" disabled={!look.canUndo} onClick={store.undo}>↶</button>
      <button title="Redo (Ctrl+Y)" aria-label="Redo" disabled={!look.canRedo} onClick={store.redo}>↷</button>
      <button class="wide" disabled={!look.view.editable || !look.view.nodes.length} title="Lay out anew; selected elements stay where they are" onClick={() => void store.arrange()}>Arrange</button>
      <button class="wide" aria-pressed={state.schematic} title="The schematic beside the bond graph" disabled={!state.schematic && !look.view.nodes.some((n) => n.kind === "part")} onClick={() => store.set({ schematic: !state.schematic })}>Schematic</button>
      {running ? (
        <>
          <progress aria-label="Progress of the run" max={until} value={running.t} />
          <button class="run" onClick={store.cancel}>Cancel</button>
        </>
      ) : (
        <button class="run" disabled={errors > 0} title="Run (Ctrl+Enter)" onClick={() => void store.start()}>▶ Run</button>
      )}
      <button aria-label="Dark or light" title="Dark or light" onClick={() => store.set({ dark: !(state.dark ?? matchMedia("(prefers-color-scheme: dark)").matches) })}>◐</button>
    </header>
  );
}

function Menu({ store, state }: { store: Store; state: State }) {
  const close = (e: Event) => (e.currentTarget as HTMLElement).closest("details")!.removeAttribute("open");
  const open = (what: object) => {
    store.set({ level: "", mode: null, nodes: new Set(), bonds: new Set(), run: null, cursor: null, instant: null, plotted: [], sweep: null, plan: null, planShown: false, asking: null, bottom: false });
    void store.ask("open", { ...what, level: "" });
  };
  const save = () => {
    const name = prompt("Name of the file", "model.toml");
    if (name) void store.ask("save as", { file: name.endsWith(".toml") ? name : `${name}.toml` });
  };
  const picture = async (form: string, schematic = false) => {
    try {
      const { content, name } = await store.transport.ask<{ content: string; name: string }>("picture", { form, schematic, mode: state.mode });
      const bytes = Uint8Array.from(atob(content), (c) => c.charCodeAt(0));
      const link = document.createElement("a");
      link.href = URL.createObjectURL(new Blob([bytes]));
      link.download = name;
      link.click();
      URL.revokeObjectURL(link.href);
    } catch (error) {
      store.refused(error);
    }
  };
  const stock = state.stock;
  return (
    <details class="menu">
      <summary aria-label="Menu">hybond</summary>
      <div class="sheet" onClick={(e) => (e.target as HTMLElement).tagName === "BUTTON" && close(e)}>
        <button onClick={() => open({})}>New model</button>
        <button onClick={save}>Save as …</button>
        <hr />
        {["svg", "pdf", "png", "tex"].map((form) => (
          <button onClick={() => void picture(form)}>Picture as {form === "tex" ? "TikZ" : form.toUpperCase()}</button>
        ))}
        <button onClick={() => void picture("svg", true)}>Schematic as SVG</button>
        <hr />
        <label>
          open{" "}
          <select aria-label="Open a file" value="" onChange={(e) => { open({ file: e.currentTarget.value }); close(e); }}>
            <option value="">a file …</option>
            {stock?.files.map((f) => <option>{f}</option>)}
          </select>
        </label>
        <label>
          open{" "}
          <select aria-label="Open an example" value="" onChange={(e) => { open({ example: e.currentTarget.value }); close(e); }}>
            <option value="">an example …</option>
            {stock?.examples.map((f) => <option>{f}</option>)}
          </select>
        </label>
        <small>hybond {stock?.version}</small>
      </div>
    </details>
  );
}
