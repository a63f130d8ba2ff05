/**
 * Bonds as draw/geometry.py draws them: half arrow, stroke, clearance. x right, y down, pixels.
 *
 * The two texts are held equal by tests/studio/test_geometry.py.
 */
export type Point = [number, number];
export type Segment = [Point, Point];
export interface Box {
  x0: number;
  y0: number;
  x1: number;
  y1: number;
}
export interface BondShape {
  tail: Point;
  head: Point;
  barb: Segment;
}

/** The node that an end of a bond names, less its port; an array may have dots in its brackets. */
export const nodeOf = (end: string): string => /^[^.[]*(?:\[[^\]]*\])?/.exec(end)![0];

export const CLEARANCE = 5.5;
export const BARB_LENGTH = 11;
export const BARB_ANGLE = (35 * Math.PI) / 180;
export const STROKE_LENGTH = 15;
export const PARALLEL = 9;

export function grown(b: Box, by: number): Box {
  return { x0: b.x0 - by, y0: b.y0 - by, x1: b.x1 + by, y1: b.y1 + by };
}

/** The fractions of a segment at which it enters and leaves the box (Liang and Barsky). */
export function cut(box: Box, [a, b]: Segment): [number, number] | null {
  let low = 0;
  let high = 1;
  const ways: [number, number, number, number][] = [
    [a[0], b[0] - a[0], box.x0, box.x1],
    [a[1], b[1] - a[1], box.y0, box.y1],
  ];
  for (const [start, step, least, most] of ways) {
    if (step === 0) {
      if (!(least < start && start < most)) return null;
      continue;
    }
    const one = (least - start) / step;
    const two = (most - start) / step;
    low = Math.max(low, Math.min(one, two));
    high = Math.min(high, Math.max(one, two));
  }
  return low < high ? [low, high] : null;
}

/** The unit normal on the barb's side: below a horizontal bond, left of a vertical one. */
export function barbSide(dx: number, dy: number): Point {
  const long = Math.hypot(dx, dy);
  const nx = -dy / long;
  const ny = dx / long;
  const below = Math.abs(dx) >= Math.abs(dy) ? ny > 0 : nx < 0;
  return below ? [nx + 0, ny + 0] : [-nx + 0, -ny + 0];
}

export function bondShape(tail: Box, head: Box, a: Point, b: Point, shift = 0): BondShape {
  const dx = b[0] - a[0];
  const dy = b[1] - a[1];
  const long = Math.hypot(dx, dy);
  if (long === 0) return { tail: a, head: b, barb: [b, b] };
  const [nx, ny] = barbSide(dx, dy);
  const p: Point = [a[0] + shift * nx, a[1] + shift * ny];
  const q: Point = [b[0] + shift * nx, b[1] + shift * ny];
  const out = cut(grown(tail, CLEARANCE), [p, q]);
  const into = cut(grown(head, CLEARANCE), [p, q]);
  let first = out ? out[1] : 0;
  let last = into ? into[0] : 1;
  if (last <= first) {
    first = 0.35;
    last = 0.65;
  }
  const start: Point = [p[0] + first * dx, p[1] + first * dy];
  const end: Point = [p[0] + last * dx, p[1] + last * dy];
  const ux = dx / long;
  const uy = dy / long;
  const size = Math.min(BARB_LENGTH, 0.5 * long * (last - first));
  const back = size * Math.cos(BARB_ANGLE);
  const aside = size * Math.sin(BARB_ANGLE);
  const tip: Point = [end[0] - back * ux + aside * nx, end[1] - back * uy + aside * ny];
  return { tail: start, head: end, barb: [end, tip] };
}

export function stroke(shape: BondShape, end: number): Segment {
  const dx = shape.head[0] - shape.tail[0];
  const dy = shape.head[1] - shape.tail[1];
  if (dx === 0 && dy === 0) return [shape.head, shape.head];
  const [nx, ny] = barbSide(dx, dy);
  const [x, y] = end ? shape.head : shape.tail;
  const half = STROKE_LENGTH / 2;
  return [
    [x + half * nx, y + half * ny],
    [x - half * nx, y - half * ny],
  ];
}

const NARROW = new Set([..."iljI|.,:;'!()[]{}/\\ ·‹›-ftr\"²³°"]);
const WIDE = new Set([..."mwMW@%…+=<>~ΩQOGD&→δ_"]);

/** How wide a text is at most, as draw/measure.py tells it. */
export function width(text: string, size: number, bold = false): number {
  let units = 0;
  for (const c of text) {
    if (NARROW.has(c)) units += 0.42;
    else if (WIDE.has(c)) units += 0.88;
    else if (c !== c.toLowerCase() && c === c.toUpperCase()) units += 0.7;
    else units += (c.codePointAt(0) ?? 0) < 0x2e80 ? 0.64 : 1.05;
  }
  return units * size * (bold ? 1.1 : 1);
}

export const CAP = 0.73;
export const LETTERS = 19;

/** The box of a symbol's letters, with the subscript of a controlled one. */
export function letterBox(letters: string, controlled: boolean, [x, y]: Point): Box {
  let half = Math.max(width(letters, LETTERS, true) / 2, 6);
  if (controlled) half += 6;
  const box = {
    x0: x - half,
    y0: y - (CAP * LETTERS) / 2 - 1,
    x1: x + half,
    y1: y + (CAP * LETTERS) / 2 + (controlled ? 3 : 1),
  };
  return controlled ? grown(box, 2) : box;
}

/** The sides of a node at which bonds leave. */
export function sides(at: Point, others: Point[]): Set<string> {
  const found = new Set<string>();
  for (const [x, y] of others) {
    const dx = x - at[0];
    const dy = y - at[1];
    if (Math.abs(dy) >= 0.3 * Math.abs(dx)) found.add(dy > 0 ? "s" : "n");
    if (Math.abs(dx) >= 0.3 * Math.abs(dy)) found.add(dx > 0 ? "e" : "w");
  }
  return found;
}
