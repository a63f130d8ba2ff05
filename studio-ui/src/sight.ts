/** Which part of a graph is in sight: shown as a whole, zoomed, pinched. */
import type { Point } from "./geometry";
import { CELL } from "./shapes";

/** The part of the graph that is in sight: where its origin is, and how large a pixel of it. */
export interface Sight {
  x: number;
  y: number;
  k: number;
}

const [LEAST, MOST] = [0.05, 6];

/** All nodes in a window, not larger than they are printed and half as much again. */
export function fitted(nodes: { x: number; y: number }[], wide: number, high: number): Sight {
  if (!nodes.length || !wide) return { x: wide / 2, y: high / 2, k: 1 };
  const xs = nodes.map((n) => n.x * CELL[0]);
  const ys = nodes.map((n) => n.y * CELL[1]);
  const [x0, x1] = [Math.min(...xs) - 90, Math.max(...xs) + 90];
  const [y0, y1] = [Math.min(...ys) - 60, Math.max(...ys) + 70];
  const k = Math.min(1.5, wide / (x1 - x0), high / (y1 - y0));
  return { k, x: wide / 2 - (k * (x0 + x1)) / 2, y: high / 2 - (k * (y0 + y1)) / 2 };
}

/** Larger by a factor, with a place that stays where it is. */
export function zoomed({ x, y, k }: Sight, factor: number, [px, py]: Point): Sight {
  const now = Math.max(LEAST, Math.min(MOST, k * factor));
  return { k: now, x: px - ((px - x) * now) / k, y: py - ((py - y) * now) / k };
}

/** Two fingers have moved, and what is under them with them. */
export function pinched(sight: Sight, [a, b]: [Point, Point], [p, q]: [Point, Point]): Sight {
  const was = Math.hypot(a[0] - b[0], a[1] - b[1]);
  const is = Math.hypot(p[0] - q[0], p[1] - q[1]);
  const k = Math.max(LEAST, Math.min(MOST, (sight.k * is) / Math.max(was, 1)));
  const [mx, my] = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
  const [nx, ny] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  return { k, x: mx - ((nx - sight.x) * k) / sight.k, y: my - ((ny - sight.y) * k) / sight.k };
}
