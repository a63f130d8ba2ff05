/** The canvas: everything that the pointer and the keyboard do to a bond graph. */
import { Component, createRef } from "preact";
import { BondShapeView, CELL, NodeShape, boxOf, joint, pixels, portSides } from "./shapes";
import { bondShape, nodeOf, sides, type Point } from "./geometry";
import type { GraphNode, Strokes } from "./messages";
import { InstantShown, Minimap, nearest, type Sight } from "./overlays";
import { quantity } from "./quantities";
import type { State, Store } from "./store";

type Gesture =
  | { kind: "press"; node: string; start: Point; at: Point; id: number; add: boolean }
  | { kind: "drag"; names: string[]; start: Point; id: number }
  | { kind: "pan"; last: Point; id: number; moved: boolean }
  | { kind: "box"; start: Point; now: Point; id: number; add: boolean }
  | { kind: "wire"; from: string; start: Point; now: Point; target: string; id: number }
  | { kind: "pinch"; ids: [number, number]; last: [Point, Point] };

interface Props {
  store: Store;
  state: State;
}

interface Own {
  sight: Sight;
  gesture: Gesture | null;
  moved: Point;
}

/** Which ends bonds have in common, ranges of arrays left out: these are drawn side by side. */
const pairOf = (ends: string[]) => ends.map((e) => e.replace(/\[[^\]]*\]/g, "")).sort().join("|");

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

  /** A level that is opened is shown as a whole. */
  private fitOnce(): void {
    const look = this.props.state.look;
    if (!look) return;
    const now = `${look.file}:${look.view.path}`;
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
    if (!nodes.length || !r.width) {
      this.setState({ sight: { x: r.width / 2, y: r.height / 2, k: 1 } });
      return;
    }
    const xs = nodes.map((n) => n.x * CELL[0]);
    const ys = nodes.map((n) => n.y * CELL[1]);
    const [x0, x1] = [Math.min(...xs) - 90, Math.max(...xs) + 90];
    const [y0, y1] = [Math.min(...ys) - 60, Math.max(...ys) + 70];
    const k = Math.min(1.5, r.width / (x1 - x0), r.height / (y1 - y0));
    this.setState({
      sight: { k, x: r.width / 2 - (k * (x0 + x1)) / 2, y: r.height / 2 - (k * (y0 + y1)) / 2 },
    });
  };

  zoom(factor: number, at?: Point): void {
    this.touched = true;
    const r = this.svg.current!.getBoundingClientRect();
    const [px, py] = at ?? [r.width / 2, r.height / 2];
    const { x, y, k } = this.state.sight;
    const now = Math.max(0.05, Math.min(6, k * factor));
    this.setState({ sight: { k: now, x: px - ((px - x) * now) / k, y: py - ((py - y) * now) / k } });
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
      const [a, b] = gesture.last;
      const was = Math.hypot(a[0] - b[0], a[1] - b[1]);
      const is = Math.hypot(p[0] - q[0], p[1] - q[1]);
      const k = Math.max(0.05, Math.min(6, (sight.k * is) / Math.max(was, 1)));
      const [mx, my] = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
      const [nx, ny] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
      this.setState({
        sight: { k, x: mx - ((nx - sight.x) * k) / sight.k, y: my - ((ny - sight.y) * k) / sight.k },
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
  private place(at: Record<string, Point>): void {
    const { store, state } = this.props;
    const look = state.look!;
    const nodes = look.view.nodes.map((n) =>
      at[n.name] ? { ...n, x: at[n.name][0], y: at[n.name][1] } : n,
    );
    store.set({ look: { ...look, view: { ...look.view, nodes } } });
  }

  private centreOf(end: string, by: Map<string, GraphNode>, at: Map<string, Point>, ports: Map<string, string>): Point {
    const name = nodeOf(end);
    return joint(by.get(name)!, end, false, at.get(name)!, ports.get(name))[0];
  }

  private enter(name: string): void {
    const { store, state } = this.props;
    const node = state.look?.view.nodes.find((n) => n.name === name);
    if (node?.kind === "part" && node.known) store.open(state.level ? `${state.level}.${name}` : name);
    else {
      store.set({ tab: "item" });
      requestAnimationFrame(() => document.querySelector<HTMLElement>(".side [data-first]")?.focus());
    }
  }

  private key = (e: KeyboardEvent): void => {
    const { store, state } = this.props;
    const nodes = state.look?.view.nodes ?? [];
    const ctrl = e.ctrlKey || e.metaKey;
    const one = state.nodes.size === 1 ? nodes.find((n) => state.nodes.has(n.name)) : undefined;
    const arrow = ARROWS[e.key];
    if (arrow && e.altKey && state.nodes.size) {
      const step = e.shiftKey ? 0.25 : 1;
      const at: Record<string, Point> = {};
      for (const n of nodes)
        if (state.nodes.has(n.name)) at[n.name] = [n.x + step * arrow[0], n.y + step * arrow[1]];
      this.place(at);
      void store.edit({ do: "move", at });
    } else if (arrow && !ctrl) {
      const from = one ?? nodes[0];
      if (!from) return;
      const next = one ? nearest(nodes, one, arrow) : from;
      if (next) store.set({ nodes: new Set([next.name]), bonds: new Set(), tab: "item" });
    } else if (e.key === "Tab" && !ctrl) return;
    else if ((e.key === "[" || e.key === "]") && state.look) {
      const all = state.look.view.bonds.filter((b) => !one || b.tail === one.name || b.head === one.name);
      const list = all.length ? all : state.look.view.bonds;
      const k = list.findIndex((b) => state.bonds.has(b.key));
      const next = list[(k + (e.key === "]" ? 1 : -1) + list.length) % list.length];
      if (next) store.set({ bonds: new Set([next.key]), tab: "item" });
    } else if (e.key === "Escape") store.set({ nodes: new Set(), bonds: new Set(), bondFrom: null, cursor: null, instant: null, adding: false });
    else if (e.key === "Enter" && state.bondFrom && one && one.name !== state.bondFrom) {
      void store.bond(state.bondFrom, one.name);
    } else if (e.key === "Enter" && one) this.enter(one.name);
    else if (e.key === "b" && !ctrl && one) store.set({ bondFrom: one.name });
    else if (e.key === "r" && !ctrl && state.bonds.size) store.reverse();
    else if (e.key === "a" && !ctrl) store.set({ adding: true });
    else if (e.key === "f" && !ctrl) this.fit();
    else if (e.key === "+" || e.key === "=") this.zoom(1.25);
    else if (e.key === "-") this.zoom(0.8);
    else if (e.key === "a" && ctrl) store.set({ nodes: new Set(nodes.map((n) => n.name)) });
    else if (e.key === "d" && ctrl) void store.duplicate();
    else if (e.key === "Delete" || e.key === "Backspace") store.remove();
    else if (e.key === "PageUp" && state.level) store.open(state.level.split(/\.(?![^[]*\])/).slice(0, -1).join("."));
    else return;
    e.preventDefault();
  };

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
    const drawn: Strokes = state.cursor?.strokes ?? look.strokes;
    const dragged = gesture?.kind === "drag" ? new Set(gesture.names) : null;
    const at = new Map<string, Point>();
    const by = new Map<string, GraphNode>();
    for (const n of look.view.nodes) {
      const [x, y] = pixels(n.x, n.y);
      at.set(n.name, dragged?.has(n.name) ? [x + moved[0], y + moved[1]] : [x, y]);
      by.set(n.name, n);
    }
    const controlled = (n: GraphNode) => drawn.nodes[n.name]?.controlled ?? (!!n.machine || !!n.law);
    const around = new Map<string, Point[]>();
    const pairs = new Map<string, string[]>();
    for (const b of look.view.bonds) {
      if (!around.has(b.tail)) around.set(b.tail, []);
      if (!around.has(b.head)) around.set(b.head, []);
      around.get(b.tail)!.push(at.get(b.head)!);
      around.get(b.head)!.push(at.get(b.tail)!);
      const pair = pairOf(b.ends);
      pairs.set(pair, [...(pairs.get(pair) ?? []), b.key]);
    }
    const toward = new Map<string, Point>();
    for (const b of look.view.bonds)
      for (const [end, own, other] of [[b.ends[0], b.tail, b.head], [b.ends[1], b.head, b.tail]])
      {
        const [x, y] = toward.get(end) ?? [0, 0];
        const [p, q] = [at.get(own)!, at.get(other)!];
        toward.set(end, [x + q[0] - p[0], y + q[1] - p[1]]);
      }
    const ports = new Map<string, string>();
    for (const n of look.view.nodes) if (n.kind === "part") ports.set(n.name, portSides(n, toward));
    const portsOf = (name: string) => ports.get(name) ?? "";
    const values = state.cursor?.values;
    const most = values
      ? Math.max(1e-300, ...Object.values(values).map((v) => Math.abs((v.e ?? 0) * (v.f ?? 0))))
      : 1;
    const target = gesture?.kind === "wire" ? nodeOf(gesture.target) : "";
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
          <defs>
            <pattern id="dots" width={CELL[0] / 4} height={CELL[1] / 4} patternUnits="userSpaceOnUse" patternTransform={`translate(${sight.x},${sight.y}) scale(${sight.k})`}>
              <circle cx={0} cy={0} r={0.7} class="dot" />
            </pattern>
            <marker id="signal" viewBox="0 0 8 8" refX={7} refY={4} markerWidth={7} markerHeight={7} orient="auto">
              <path d="M0,1L8,4L0,7z" class="signalhead" />
            </marker>
          </defs>
          {sight.k > 0.45 && <rect class="paper" width="100%" height="100%" fill="url(#dots)" />}
          <g transform={`translate(${sight.x},${sight.y}) scale(${sight.k})`}>
            {look.view.modulations.map((m) => {
              const a = by.get(m.from)!;
              const b = by.get(m.to)!;
              if (!a || !b) return null;
              const [p, q] = [at.get(m.from)!, at.get(m.to)!];
              const s = bondShape(boxOf(a, controlled(a), p, portsOf(a.name)), boxOf(b, controlled(b), q, portsOf(b.name)), p, q, 7);
              return (
                <line class="signal" x1={s.tail[0]} y1={s.tail[1]} x2={s.head[0]} y2={s.head[1]} marker-end="url(#signal)" />
              );
            })}
            {/* each kind in a group of its own: a browser lays out all that a changed group holds */}
            <g>{look.view.bonds.map((b) => {
              const [tail, head] = [by.get(b.tail)!, by.get(b.head)!];
              const [t, h] = [at.get(b.tail)!, at.get(b.head)!];
              const same = pairs.get(pairOf(b.ends))!;
              const value = values?.[b.key];
              return (
                <BondShapeView
                  key={b.key}
                  bond={b}
                  tail={tail}
                  head={head}
                  tx={t[0]}
                  ty={t[1]}
                  hx={h[0]}
                  hy={h[1]}
                  tailControlled={controlled(tail)}
                  headControlled={controlled(head)}
                  tailPorts={portsOf(b.tail)}
                  headPorts={portsOf(b.head)}
                  shift={same.indexOf(b.key) - (same.length - 1) / 2}
                  drawn={drawn.bonds[b.key] ?? drawn.bonds[`${b.ends[0]} -> ${b.ends[1]}`]}
                  selected={state.bonds.has(b.key)}
                  effort={value && sight.k > 0.6 ? quantity(value.e, value.units[0]) : ""}
                  rate={value && sight.k > 0.6 ? quantity(value.f, value.units[1]) : ""}
                  flow={state.flowing && value ? ((value.e ?? 0) * (value.f ?? 0)) / most : 0}
                />
              );
            })}</g>
            <g>{look.view.nodes.map((n) => (
              <NodeShape
                key={n.name}
                node={n}
                x={at.get(n.name)![0]}
                y={at.get(n.name)![1]}
                state={drawn.nodes[n.name]}
                selected={state.nodes.has(n.name)}
                ports={portsOf(n.name)}
                target={target === n.name || state.bondFrom === n.name}
                taken={[...sides(at.get(n.name)!, around.get(n.name) ?? [])].sort().join("")}
              />
            ))}</g>
            {gesture?.kind === "wire" && (
              <Wire from={this.centreOf(gesture.from, by, at, ports)} to={gesture.now} />
            )}
            {gesture?.kind === "box" && (
              <rect
                class="marquee"
                x={Math.min(gesture.start[0], gesture.now[0])}
                y={Math.min(gesture.start[1], gesture.now[1])}
                width={Math.abs(gesture.now[0] - gesture.start[0])}
                height={Math.abs(gesture.now[1] - gesture.start[1])}
              />
            )}
          </g>
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

function Wire({ from, to }: { from: Point; to: Point }) {
  return <line class="wire" x1={from[0]} y1={from[1]} x2={to[0]} y2={to[1]} />;
}

const sub = (a: Point, b: Point): Point => [a[0] - b[0], a[1] - b[1]];

const ARROWS: Record<string, Point> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};
