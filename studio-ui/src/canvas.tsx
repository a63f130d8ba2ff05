/** The canvas: what the pointer does to a bond graph, and which part of it is in sight. */
import { Component, createRef } from "preact";
import { nodeOf, type Point } from "./geometry";
import { GraphPicture, type Gesture } from "./graph";
import { keyed } from "./keys";
import { InstantShown, Minimap } from "./overlays";
import { CELL, pixels } from "./shapes";
import { fitted, pinched, zoomed, type Sight } from "./sight";
import type { State, Store } from "./store";

interface Props {
  store: Store;
  state: State;
}

interface Own {
  sight: Sight;
  gesture: Gesture | null;
  moved: Point;
}

export class Canvas extends Component<Props, Own> {
  svg = createRef<SVGSVGElement>();
  state: Own = { sight: { x: 60, y: 120, k: 1 }, gesture: null, moved: [0, 0] };
  private pointers = new Map<number, Point>();
  private fitted = "";
  private lastTap = { time: 0, node: "" };

  private watch = new ResizeObserver(() => this.resized());
  private size: Point = [0, 0];
  private touched = false;

  componentDidMount(): void {
    this.listen();
    this.fitOnce();
  }

  componentWillUnmount(): void {
    this.watch.disconnect();
    this.svg.current?.removeEventListener("wheel", this.wheel);
  }

  private listening: SVGSVGElement | null = null;

  /** The picture appears with the first answer: its listeners come then. */
  private listen(): void {
    const svg = this.svg.current;
    if (!svg || svg === this.listening) return;
    this.listening = svg;
    svg.addEventListener("wheel", this.wheel, { passive: false });
    this.watch.observe(svg);
  }

  /** What was shown as a whole stays so; else the middle stays the middle. */
  private resized(): void {
    const r = this.svg.current?.getBoundingClientRect();
    if (!r || (r.width === this.size[0] && r.height === this.size[1])) return;
    const [w, h] = this.size;
    this.size = [r.width, r.height];
    if (!this.touched) this.fit();
    else if (w) {
      const s = this.state.sight;
      this.setState({ sight: { ...s, x: s.x + (r.width - w) / 2, y: s.y + (r.height - h) / 2 } });
    }
  }

  componentDidUpdate(): void {
    this.listen();
    this.fitOnce();
    this.keepInSight();
  }

  private seen = "";

  /** What was just put down or selected is in sight. */
  private keepInSight(): void {
    const { state } = this.props;
    const look = state.look;
    if (!look || !this.svg.current || this.state.gesture) return;
    const now = [...state.nodes].join(" ");
    if (now === this.seen) return;
    this.seen = now;
    const r = this.svg.current.getBoundingClientRect(); // makes the browser lay out: asked for last
    const chosen = look.view.nodes.filter((n) => state.nodes.has(n.name));
    const { x, y, k } = this.state.sight;
    const out = chosen.some((n) => {
      const [px, py] = pixels(n.x, n.y);
      const [sx, sy] = [x + k * px, y + k * py];
      return sx < 40 || sy < 40 || sx > r.width - 40 || sy > r.height - 40;
    });
    if (!out || !chosen.length) return;
    if (!this.touched) this.fit();
    else {
      const [px, py] = pixels(chosen[0].x, chosen[0].y);
      this.setState({ sight: { k, x: r.width / 2 - k * px, y: r.height / 2 - k * py } });
    }
  }

  /** A level that is opened, or laid out anew, is shown as a whole. */
  private fitOnce(): void {
    const look = this.props.state.look;
    if (!look) return;
    const now = `${look.file}:${look.view.path}:${this.props.state.arranged}`;
    if (this.fitted !== now && look.view.nodes.length) {
      this.fitted = now;
      this.touched = false;
      this.fit();
    }
  }

  fit = (): void => {
    const nodes = this.props.state.look?.view.nodes ?? [];
    const svg = this.svg.current;
    if (!svg) return;
    const r = svg.getBoundingClientRect();
    this.setState({ sight: fitted(nodes, r.width, r.height) });
  };

  zoom(factor: number, at?: Point): void {
    this.touched = true;
    const r = this.svg.current!.getBoundingClientRect();
    this.setState({ sight: zoomed(this.state.sight, factor, at ?? [r.width / 2, r.height / 2]) });
  }

  private wheel = (e: WheelEvent): void => {
    e.preventDefault();
    const r = this.svg.current!.getBoundingClientRect();
    if (e.shiftKey && !e.ctrlKey) {
      const s = this.state.sight;
      this.setState({ sight: { ...s, x: s.x - e.deltaY, y: s.y - e.deltaX } });
    } else this.zoom(Math.exp(-e.deltaY * 0.0015), [e.clientX - r.left, e.clientY - r.top]);
  };

  private local(e: PointerEvent | MouseEvent): Point {
    const r = this.svg.current!.getBoundingClientRect();
    return [e.clientX - r.left, e.clientY - r.top];
  }

  private inGraph([px, py]: Point): Point {
    const { x, y, k } = this.state.sight;
    return [(px - x) / k, (py - y) / k];
  }

  /** What lies under a place of the screen: a port, a node. */
  private under(e: PointerEvent, but = ""): string {
    for (const found of document.elementsFromPoint(e.clientX, e.clientY)) {
      const port = found.closest?.("[data-port]")?.getAttribute("data-port");
      if (port && nodeOf(port) !== but) return port;
      const node = found.closest?.("[data-node]")?.getAttribute("data-node");
      if (node && node !== but) return node;
    }
    return "";
  }

  private down = (e: PointerEvent): void => {
    const { store, state } = this.props;
    const at = this.local(e);
    this.pointers.set(e.pointerId, at);
    this.svg.current!.focus({ preventScroll: true });
    if (this.pointers.size === 2) {
      const [[a, p], [b, q]] = [...this.pointers];
      this.setState({ gesture: { kind: "pinch", ids: [a, b], last: [p, q] }, moved: [0, 0] });
      return;
    }
    const target = e.target as Element;
    const add = e.shiftKey || e.ctrlKey || e.metaKey;
    const handle = target.closest("[data-handle]")?.getAttribute("data-handle");
    const port = target.closest("[data-port]")?.getAttribute("data-port");
    const node = target.closest("[data-node]")?.getAttribute("data-node");
    const bond = target.closest("[data-bond]")?.getAttribute("data-bond");
    const from = handle ?? port ?? (node && (e.altKey || state.drawing) ? node : undefined);
    if (e.button === 1 || (e.button === 0 && e.metaKey && !node && !bond)) {
      this.begin(e, { kind: "pan", last: at, id: e.pointerId, moved: false });
    } else if (e.button !== 0) return;
    else if (from && state.look?.view.editable) {
      this.begin(e, {
        kind: "wire",
        from,
        start: at,
        now: this.inGraph(at),
        target: "",
        id: e.pointerId,
      });
    } else if (node) {
      if (state.bondFrom && state.bondFrom !== node) {
        void store.bond(state.bondFrom, this.under(e) || node);
        return;
      }
      if (!state.nodes.has(node))
        store.set({
          nodes: add ? new Set([...state.nodes, node]) : new Set([node]),
          bonds: add ? state.bonds : new Set(),
          tab: state.tab === "problems" || state.tab === "text" ? state.tab : "item",
        });
      else if (add) {
        const less = new Set(state.nodes);
        less.delete(node);
        store.set({ nodes: less });
        return;
      }
      this.begin(e, { kind: "press", node, start: this.inGraph(at), at, id: e.pointerId, add });
    } else if (bond) {
      const bonds = new Set(add ? state.bonds : []);
      if (add && state.bonds.has(bond)) bonds.delete(bond);
      else bonds.add(bond);
      store.set({ bonds, nodes: add ? state.nodes : new Set(), tab: "item" });
    } else if (e.pointerType === "touch") {
      this.begin(e, { kind: "pan", last: at, id: e.pointerId, moved: false });
    } else {
      if (!add) store.set({ nodes: new Set(), bonds: new Set(), bondFrom: null });
      this.begin(e, { kind: "box", start: this.inGraph(at), now: this.inGraph(at), id: e.pointerId, add });
    }
  };

  private begin(e: PointerEvent, gesture: Gesture): void {
    // a press captures nothing: the double click must still come to the node
    if (gesture.kind !== "press") this.svg.current!.setPointerCapture(e.pointerId);
    this.setState({ gesture, moved: [0, 0] });
  }

  private move = (e: PointerEvent): void => {
    const { gesture, sight } = this.state;
    const at = this.local(e);
    if (gesture?.kind === "pan" || gesture?.kind === "pinch") this.touched = true;
    if (this.pointers.has(e.pointerId)) this.pointers.set(e.pointerId, at);
    if (!gesture) return;
    if (gesture.kind === "pinch") {
      const [p, q] = gesture.ids.map((id) => this.pointers.get(id)!) as [Point, Point];
      this.setState({
        sight: pinched(sight, gesture.last, [p, q]),
        gesture: { ...gesture, last: [p, q] },
      });
      return;
    }
    if (gesture.id !== e.pointerId) return;
    if (gesture.kind === "press") {
      if (Math.hypot(at[0] - gesture.at[0], at[1] - gesture.at[1]) < 5) return;
      if (!this.props.state.look?.view.editable) return;
      this.svg.current!.setPointerCapture(e.pointerId);
      const names = [...this.props.state.nodes];
      this.setState({ gesture: { kind: "drag", names, start: gesture.start, id: gesture.id } });
    } else if (gesture.kind === "drag") {
      const [x, y] = this.inGraph(at);
      this.setState({ moved: [x - gesture.start[0], y - gesture.start[1]] });
    } else if (gesture.kind === "pan") {
      this.setState({
        sight: { ...sight, x: sight.x + at[0] - gesture.last[0], y: sight.y + at[1] - gesture.last[1] },
        gesture: { ...gesture, last: at, moved: true },
      });
    } else if (gesture.kind === "box") this.setState({ gesture: { ...gesture, now: this.inGraph(at) } });
    else if (gesture.kind === "wire") {
      const target = this.under(e, nodeOf(gesture.from));
      this.setState({ gesture: { ...gesture, now: this.inGraph(at), target } });
    }
  };

  private up = (e: PointerEvent): void => {
    const { gesture, moved } = this.state;
    const { store, state } = this.props;
    this.pointers.delete(e.pointerId);
    if (!gesture) return;
    if (gesture.kind === "pinch") {
      this.setState({ gesture: null });
      return;
    }
    if (gesture.id !== e.pointerId) return;
    if (gesture.kind === "press") {
      const now = performance.now();
      const twice = now - this.lastTap.time < 400 && this.lastTap.node === gesture.node;
      this.lastTap = { time: now, node: gesture.node };
      if (twice) this.enter(gesture.node);
      else if (!gesture.add && state.nodes.size > 1) store.set({ nodes: new Set([gesture.node]) });
    } else if (gesture.kind === "drag") {
      const snap = e.altKey ? 0.05 : 0.25;
      const at: Record<string, Point> = {};
      for (const n of state.look!.view.nodes)
        if (gesture.names.includes(n.name)) {
          const x = n.x + moved[0] / CELL[0];
          const y = n.y + moved[1] / CELL[1];
          at[n.name] = [Math.round(x / snap) * snap, Math.round(y / snap) * snap];
        }
      this.place(at);
      void store.edit({ do: "move", at });
    } else if (gesture.kind === "box") {
      const [x0, x1] = [gesture.start[0], gesture.now[0]].sort((a, b) => a - b);
      const [y0, y1] = [gesture.start[1], gesture.now[1]].sort((a, b) => a - b);
      const inside = state.look!.view.nodes
        .filter((n) => {
          const [x, y] = pixels(n.x, n.y);
          return x >= x0 && x <= x1 && y >= y0 && y <= y1;
        })
        .map((n) => n.name);
      if (inside.length) store.set({ nodes: new Set(gesture.add ? [...state.nodes, ...inside] : inside) });
    } else if (gesture.kind === "wire") {
      const target = this.under(e, nodeOf(gesture.from)) || gesture.target;
      if (target) void store.bond(gesture.from, target);
      else if (Math.hypot(...sub(this.local(e), gesture.start)) < 8)
        store.set({ bondFrom: gesture.from }); // a tap on the handle: the next tap is the other end
    } else if (gesture.kind === "pan" && !gesture.moved) store.set({ nodes: new Set(), bonds: new Set(), bondFrom: null });
    this.setState({ gesture: null, moved: [0, 0] });
  };

  /** Show at once where nodes were dropped; the session says the same a moment later. */
  place(at: Record<string, Point>): void {
    const { store, state } = this.props;
    const look = state.look!;
    const nodes = look.view.nodes.map((n) =>
      at[n.name] ? { ...n, x: at[n.name][0], y: at[n.name][1] } : n,
    );
    store.set({ look: { ...look, view: { ...look.view, nodes } } });
  }

  enter(name: string): void {
    const { store, state } = this.props;
    const node = state.look?.view.nodes.find((n) => n.name === name);
    if (node?.kind === "part" && node.known) store.open(state.level ? `${state.level}.${name}` : name);
    else {
      store.set({ tab: "item" });
      requestAnimationFrame(() => document.querySelector<HTMLElement>(".side [data-first]")?.focus());
    }
  }

  private key = (e: KeyboardEvent): void => keyed(e, this.props.store, this);

  private dropped = (e: DragEvent): void => {
    const text = e.dataTransfer?.getData("application/x-hybond");
    if (!text) return;
    e.preventDefault();
    const { element, stem } = JSON.parse(text) as { element: object; stem: string };
    const [x, y] = this.inGraph(this.local(e));
    void this.props.store.add(element, stem, [
      Math.round((x / CELL[0]) * 4) / 4,
      Math.round((y / CELL[1]) * 4) / 4,
    ]);
  };

  render({ state, store }: Props, { sight, gesture, moved }: Own) {
    const look = state.look;
    if (!look) return <div class="canvas" />;
    return (
      <div class="canvas" onDragOver={(e) => e.preventDefault()} onDrop={this.dropped}>
        <svg
          ref={this.svg}
          tabindex={0}
          role="application"
          aria-label={`Bond graph ${look.title || look.file}: ${look.view.nodes.length} elements, ${look.view.bonds.length} bonds. Arrow keys select, a adds, b bonds, Delete removes.`}
          aria-describedby="chosen"
          onPointerDown={this.down}
          onPointerMove={this.move}
          onPointerUp={this.up}
          onPointerCancel={this.up}
          onKeyDown={this.key}
          class={state.flowing ? "flowing" : ""}
        >
          <GraphPicture state={state} sight={sight} gesture={gesture} moved={moved} />
        </svg>
        {gesture?.kind === "wire" && (
          <div class="wiretext" role="status">
            {gesture.from} {"->"} {gesture.target || "…"}
          </div>
        )}
        {state.instant && <InstantShown store={store} state={state} />}
        {state.bondFrom && (
          <div class="wiretext" role="status">
            {state.bondFrom} {"->"} {[...state.nodes].find((n) => n !== state.bondFrom) ?? "…"}: choose the other end
          </div>
        )}
        <div class="views">
          <button title="Zoom in (+)" aria-label="Zoom in" onClick={() => this.zoom(1.25)}>+</button>
          <button title="Zoom out (-)" aria-label="Zoom out" onClick={() => this.zoom(0.8)}>−</button>
          <button title="Show all (f)" aria-label="Show all" onClick={this.fit}>⤢</button>
        </div>
        <Minimap state={state} sight={sight} size={this.size} />
        {look.view.crumbs.length > 0 && (
          <nav class="crumbs" aria-label="Submodel">
            <button onClick={() => store.open("")}>{look.title || look.file}</button>
            {look.view.crumbs.map((c, k) => (
              <>
                {" › "}
                <button onClick={() => store.open(look.view.crumbs.slice(0, k + 1).join("."))}>{c}</button>
              </>
            ))}
            {!look.view.editable && <span> ({look.view.name}, a ready part: to look at)</span>}
          </nav>
        )}
      </div>
    );
  }
}

const sub = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1]];
