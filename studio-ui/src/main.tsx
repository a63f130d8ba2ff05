/** The page in the browser. */
import { render } from "preact";
import { App } from "./app";
import { bondShape, stroke, width, type Point } from "./geometry";
import { Store } from "./store";
import "./style.css";
import "./sweep.css";
import { Transport, overSocket } from "./transport";

const transport = new Transport();
const store = new Store(transport);
overSocket(transport, (connected) => (connected ? void store.begin() : store.set({ connected })));
render(<App store={store} whole />, document.getElementById("studio")!);

// what tests/studio compares with draw/geometry.py
(window as unknown as Record<string, unknown>).hybondGeometry = (asked: {
  cases: [Point, Point, number][];
  words: string[];
}) => ({
  shapes: asked.cases.map(([a, b, shift]) => {
    const [p, q] = [a, b].map(([x, y]) => ({ x0: x - 8, y0: y - 9, x1: x + 8, y1: y + 9 }));
    const s = bondShape(p, q, a, b, shift);
    return [s.tail, s.head, s.barb, stroke(s, 0), stroke(s, 1)];
  }),
  widths: asked.words.map((w) => width(w, 10)),
});
