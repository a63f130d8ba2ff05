/** Scales and ticks of the views of sweeps. No numbers of a sweep are computed here. */
import type { AxisOf } from "./messages";
import { number, printed } from "./quantities";

/** `a..b` of `a..b` and `a..b:11`, null of anything else. */
export function span(values: string): string | null {
  return /^([^:,()]+\.\.[^:,()]+?)(:11)?$/.exec(values.trim())?.[1] ?? null;
}

export interface Scale {
  low: number;
  high: number;
  log: boolean;
  /** 0 at the lower end, 1 at the upper. */
  part: (v: number) => number;
  value: (part: number) => number;
  ticks: number[];
}

export function scale(low: number, high: number, log: boolean, many = 5): Scale {
  // what differs in its last digits alone is one value
  if (!(high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high)))) {
    const room = Math.abs(low) * 0.1 || 1;
    [low, high] = log ? [low * 0.9, low * 1.1] : [low - room, high + room];
  }
  if (!log) return { low, high, log, part: (v) => (v - low) / (high - low), value: (p) => low + p * (high - low), ticks: even(low, high, many) };
  const [a, b] = [Math.log(low), Math.log(high)];
  return { low, high, log, part: (v) => (Math.log(v) - a) / (b - a), value: (p) => Math.exp(a + p * (b - a)), ticks: decades(low, high, many) };
}

/** The scale of an axis: around the cells of a grid, with some room around points. */
export function scaleOf(axis: AxisOf, values: (number | null)[], many: number): Scale {
  if (axis.edges) return scale(axis.edges[0], axis.edges[axis.edges.length - 1], axis.log, many);
  const there = values.filter((v): v is number => v !== null);
  const [low, high] = ends(there);
  if (axis.log) return scale(low / (high / low) ** 0.04, high * (high / low) ** 0.04, true, many);
  const room = 0.05 * (high - low);
  return scale(low - room, high + room, false, many);
}

export function ends(values: number[]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const v of values) {
    if (v < low) low = v;
    if (v > high) high = v;
  }
  return low <= high ? [low, high] : [0, 1];
}

function even(low: number, high: number, many: number): number[] {
  const raw = (high - low) / many;
  const ten = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((f) => f * ten).find((s) => s >= raw * 0.999) ?? raw;
  const found: number[] = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-12) + 1e-9 * step; k++) found.push(+(k * step).toPrecision(12));
  return found;
}

function decades(low: number, high: number, many: number): number[] {
  const found: number[] = [];
  for (const digits of [[1], [1, 3], [1, 2, 5]]) {
    found.length = 0;
    for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); k++)
      for (const d of digits) if (d * 10 ** k >= low * 0.999 && d * 10 ** k <= high * 1.001) found.push(+(d * 10 ** k).toPrecision(6));
    if (found.length >= many - 2) break;
  }
  return found.length > 1 ? found : [low, high];
}

export function named(name: string, unit: string): string {
  return unit ? `${name} [${printed(unit)}]` : name;
}

export function said(v: number | null): string {
  return v === null ? "none" : number(v, 5).replace(/\.?0+e/, "e");
}

const STOPS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"];

/** Viridis, dark blue at 0 to yellow at 1, in even steps of brightness. */
export function viridis(part: number): string {
  const at = Math.min(Math.max(part, 0), 1) * (STOPS.length - 1);
  const k = Math.min(Math.floor(at), STOPS.length - 2);
  const mix = [0, 2, 4].map((i) => {
    const [a, b] = [STOPS[k], STOPS[k + 1]].map((hex) => parseInt(hex.slice(i, i + 2), 16));
    return Math.round(a + (at - k) * (b - a));
  });
  return `rgb(${mix.join(",")})`;
}

export const GRADIENT = STOPS.map((s) => `#${s}`).join(", ");
