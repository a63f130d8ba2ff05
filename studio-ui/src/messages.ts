/** What session.py says: the records of its answers. */

export type Ends = number[];

export interface GraphNode {
  name: string;
  kind: string;
  letters: string;
  says: string;
  x: number;
  y: number;
  entry: Record<string, unknown>;
  ports?: string[];
  inputs?: string[];
  outside?: string[];
  known?: boolean;
  law?: string;
  machine?: string;
}

export interface GraphBond {
  key: string;
  tail: string;
  head: string;
  ends: [string, string];
  text: string;
}

export interface View {
  path: string;
  name: string;
  editable: boolean;
  crumbs: string[];
  domain: string;
  nodes: GraphNode[];
  bonds: GraphBond[];
  modulations: { from: string; to: string }[];
  signals: { name: string; section: string; text: string }[];
}

export interface BondStrokes {
  strokes: Ends;
  dashed?: Ends;
  late?: Ends;
  off?: boolean;
  conflict?: boolean;
  integral?: boolean;
}

export interface NodeState {
  off?: boolean;
  derivative?: boolean;
  controlled?: boolean;
  says?: string;
}

export interface Strokes {
  bonds: Record<string, BondStrokes>;
  nodes: Record<string, NodeState>;
}

export interface MachineNow {
  path: string;
  states: string[];
  state: string;
  law: string;
}

export interface Place {
  nodes?: string[];
  bonds?: string[];
  entry?: string[];
}

export interface Problem {
  grave?: "error" | "hint";
  code: string;
  where: string;
  why: string;
  try: string;
  line?: number | null;
  select?: Place;
}

export interface MachineEntry {
  states: Record<string, string[]>;
  start: string;
  rules?: string[];
}

export interface Panels {
  parameters: Record<string, string | number>;
  inputs: Record<string, unknown>;
  signals: Record<string, unknown>;
  machines: Record<string, MachineEntry>;
  blocks: Record<string, unknown>;
  experiment: Record<string, unknown>;
  ports: Record<string, string>;
}

export interface Look {
  revision: number;
  file: string;
  title: string;
  inMemory: boolean;
  writable: boolean;
  unsaved: string;
  canUndo: boolean;
  canRedo: boolean;
  view: View;
  strokes: Strokes;
  machines: MachineNow[];
  problems: Problem[];
  whole: boolean;
  panels: Panels;
  pasted?: string[];
}

export interface Stock {
  kinds: { kind: string; letters: string; about: string; stem: string; element: object }[];
  parts: {
    name: string;
    title: string;
    ports: string[];
    parameters: Record<string, string>;
    inputs: string[];
  }[];
  domains: { name: string; effort: string; flow: string }[];
  laws: string[];
  solvers: { name: string; about: string }[];
  version: string;
  files: string[];
  examples: string[];
}

export interface RunSummary {
  run: number;
  title: string;
  took: number;
  status: string;
  tEnd: number;
  tBegin: number;
  until: number;
  events: number;
  warnings: string[];
  method: string;
  names: string[];
  machines: { path: string; states: string[] }[];
  plot: string[];
  /** Whether it has values of its own, as a member of a sweep. */
  own?: boolean;
  /** When a law was first seen not to hold, s, and that in words. */
  doubt?: { t: number; said: string };
  error?: Problem;
}

export interface Fired {
  machine: string;
  source: string;
  target: string;
  guard: string;
  why: string;
}

export interface Step {
  kind: "mythical" | "pinnacle" | "continuous";
  mode: Record<string, string>;
  fired: Fired[];
  impulses: Record<string, number>;
  undetermined: string[];
  energy?: { before: string; after: string; source: string; lost: string };
  exchanged?: Record<string, number>;
}

export interface Instant {
  event: number;
  t: number;
  t0: number | null;
  cause: string;
  landed: string[];
  steps: Step[];
}

export interface Curve {
  name: string;
  unit: string;
  t: number[];
  y: (number | null)[];
  impulses: [number, number][];
  error?: Problem;
}

export interface Lane {
  machine: string;
  states: string[];
  stays?: [number, number, number][];
  shares?: number[][];
}

export interface Cursor {
  t: number;
  mode: Record<string, string>;
  /** By bond; `power` is false where effort times flow is none, as in thermal pseudo bonds. */
  values: Record<string, { e: number | null; f: number | null; units: [string, string]; power?: boolean }>;
  /** What is plotted, there. */
  signals: Record<string, number | null>;
  strokes: Strokes;
}

/** What there is of a run that goes on. */
export interface SoFar {
  run: number;
  curves: Curve[];
  strip: Lane[];
  tBegin: number;
  tEnd: number;
}

/** A tag of MathML, its attributes, then texts and tags. */
export type Formula = [string, Record<string, string>, ...(Formula | string)[]];

export interface Scene {
  width: number;
  height: number;
  groups: {
    name: string;
    key: string;
    about: string;
    marks: { role: string; d?: string; text?: string; x?: number; y?: number; anchor?: "start" | "middle" | "end" }[];
  }[];
}

export interface Member {
  member: number;
  value: string;
  status: string;
  events?: number;
  curves?: Curve[];
  modes?: number[];
  /** All modes that were met so far, by their numbers. */
  named?: string[];
  until?: number;
  error?: Problem;
}

export interface Swept {
  sweep: number;
  path: string;
  values: string[];
  members: Member[];
  done: boolean;
}

export interface Phase {
  pieces: [number[], number[]][];
  units: [string, string];
  box: [number, number, number, number];
}

export interface EnergyShare {
  name: string;
  kind: string;
  /** J. */
  energy: number;
}

/** Who gave energy and who took it, from the start of a run to a time. */
export interface Energies {
  gives: EnergyShare[];
  takes: EnergyShare[];
  start: number;
  end: number;
}

export interface Written {
  text: string;
  formula?: Formula | null;
  notes?: string[];
}

/** A plan of many runs as it is typed. */
export interface PlanForm {
  factors: { path: string; values: string }[];
  way: string;
  count: string;
  seed: string;
  until: string;
  collect: string;
}

/** What a plan may say. */
export interface PlanWords {
  paths: string[];
  values: Record<string, string>;
  ways: Record<string, string>;
  collectors: Record<string, string>;
  words: string[];
  collect: string;
}

/** What a plan comes to: `wrong` by its place on the form. */
export interface Verdict {
  members: number;
  wrong: Record<string, Problem>;
  command: string;
}

export interface PlanNow {
  plan: number;
  state: "running" | "done" | "cancelled" | "error";
  done: number;
  kept: number;
  members: number;
  took: number;
  left: number | null;
  error?: Problem;
  way: string;
  factors: { path: string; unit: string; number: boolean; levels: string[] }[];
  columns: { name: string; unit: string; kind: "number" | "whole" | "text" | "curve" }[];
}

export interface AxisOf {
  name: string;
  unit: string;
  log: boolean;
  /** Of the cells of a grid; null of points. */
  edges: number[] | null;
}

export interface OutcomeMap {
  view: "map" | "scatter";
  kept: number;
  x: AxisOf;
  y: AxisOf;
  value: string;
  unit: string;
  names: string[];
  inks: string[];
  none: string;
  members: number[];
  across: (number | null)[];
  up: (number | null)[];
  number: (number | null)[];
  all: number;
}

export interface FamilyOf {
  view: "family";
  kept: number;
  signal: string;
  unit: string;
  t: number[];
  every: number;
  bands: (number | null)[][];
  members: number[];
  curves: (number | null)[][];
}

export interface TornadoOf {
  view: "tornado";
  value: string;
  unit: string;
  middle: number | null;
  rows: { path: string; unit: string; ends: (number | null)[]; outcomes: (number | null)[]; members: number[] }[];
}

export interface SobolOf {
  view: "sobol";
  value: string;
  rows: { path: string; first: (number | null)[]; total: (number | null)[] }[];
  points: number;
  leftOut: number;
}

export interface TableOf {
  view: "table";
  kept: number;
  columns: { name: string; unit: string }[];
  first: number;
  rows: (string | number | null)[][];
}

export type ViewOf = OutcomeMap | FamilyOf | TornadoOf | SobolOf | TableOf;

export interface MemberOf {
  member: number;
  sets: Record<string, string | number>;
  row: Record<string, string | number | null> | null;
}

/** Which view of a sweep is shown, and of what. */
export interface Choice {
  view: string;
  x: string;
  y: string;
  value: string;
  curve: string;
  /** At which level of the factors that are neither across nor up. */
  at: Record<string, number>;
  /** The first row of the table. */
  first: number;
}
