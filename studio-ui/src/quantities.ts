/** Numbers and quantities as texts. */

export function number(v: number | null, digits = 4): string {
  if (v === null) return "—";
  if (v === 0) return "0";
  const size = Math.abs(v);
  return size >= 1e5 || size < 1e-3 ? v.toExponential(digits - 1) : String(+v.toPrecision(digits));
}

const PREFIXES: [number, string][] = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
  [1e-12, "p"],
];

/** A unit as it is printed: N·m. */
export function printed(unit: string): string {
  return unit.replaceAll("*", "·");
}

/** The unit of an integral over time, as of an impulse: N*s of N, rad of rad/s. */
export function overTime(unit: string): string {
  return unit.endsWith("/s") ? unit.slice(0, -2) : unit && `${unit}*s`;
}

/** A value with an engineering prefix: 1.2 kV. */
export function quantity(v: number | null, unit: string, digits = 4): string {
  if (v === null) return "—";
  if (v === 0 || !/^[A-Za-zΩ]+$/.test(unit) || unit === "kg") return `${number(v, digits)} ${printed(unit)}`.trim();
  const [factor, prefix] = PREFIXES.find(([f]) => Math.abs(v) >= f * (1 - 1e-9)) ?? PREFIXES[PREFIXES.length - 1];
  return `${+(v / factor).toPrecision(digits)} ${prefix}${unit}`.trim();
}
