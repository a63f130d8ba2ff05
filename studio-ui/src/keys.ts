/** What the keyboard does to a bond graph. */
import type { Point } from "./geometry";
import { nearest } from "./overlays";
import type { Store } from "./store";

/** What keys ask of the canvas. */
interface Asked {
  fit: () => void;
  zoom: (factor: number) => void;
  enter: (name: string) => void;
  place: (at: Record<string, Point>) => void;
}

const ARROWS: Record<string, Point> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, -1],
  ArrowDown: [0, 1],
};

/** Do what a key says; a key that says nothing here is left to the browser. */
export function keyed(e: KeyboardEvent, store: Store, canvas: Asked): void {
  const { state } = store;
  const nodes = state.look?.view.nodes ?? [];
  const ctrl = e.ctrlKey || e.metaKey;
  const one = state.nodes.size === 1 ? nodes.find((n) => state.nodes.has(n.name)) : undefined;
  const arrow = ARROWS[e.key];
  if (arrow && e.altKey && state.nodes.size) {
    const step = e.shiftKey ? 0.25 : 1;
    const at: Record<string, Point> = {};
    for (const n of nodes)
      if (state.nodes.has(n.name)) at[n.name] = [n.x + step * arrow[0], n.y + step * arrow[1]];
    canvas.place(at);
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
  } else if (e.key === "Escape") store.set({ nodes: new Set(), bonds: new Set(), bondFrom: null, cursor: null, instant: null, adding: false, finding: false });
  else if (e.key === "Enter" && state.bondFrom && one && one.name !== state.bondFrom) {
    void store.bond(state.bondFrom, one.name);
  } else if (e.key === "Enter" && one) canvas.enter(one.name);
  else if (e.key === "b" && !ctrl && one) store.set({ bondFrom: one.name });
  else if (e.key === "r" && !ctrl && state.bonds.size) store.reverse();
  else if (e.key === "a" && !ctrl) store.set({ adding: true });
  else if (e.key === "/" && !ctrl) store.set({ finding: true });
  else if (e.key === "f" && !ctrl) canvas.fit();
  else if ((e.key === "+" || e.key === "=") && !ctrl) canvas.zoom(1.25);
  else if (e.key === "-" && !ctrl) canvas.zoom(0.8);
  else if (e.key === "a" && ctrl) store.set({ nodes: new Set(nodes.map((n) => n.name)) });
  else if (e.key === "d" && ctrl) void store.duplicate();
  else if (e.key === "Delete" || e.key === "Backspace") store.remove();
  else if (e.key === "PageUp" && state.level) store.open(state.level.split(/\.(?![^[]*\])/).slice(0, -1).join("."));
  else return;
  e.preventDefault();
}
