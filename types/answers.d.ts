/**
 * What the server sends, as docs/page.md describes it: the types of the page, of the drawing
 * modules and of the report. Nothing of this file is shipped.
 */

import type { Chart } from "./charts";

export * from "./charts";

/** A number, or `null` where there is none. */
export type Maybe = number | null;

export interface Fault {
  where?: string;
  sentence: string;
}

/** A part that could not be computed. */
export interface Failed {
  fault: string;
}

// ---- the state --------------------------------------------------------------------------------

export interface Pixel {
  read_noise_e?: number;
  [key: string]: unknown;
}

export interface SensorPart {
  name: string;
  pixel?: Pixel;
  filter?: string | null;
  filter_wavelength_unit?: string | null;
  shift_ircut_nm?: number;
  ircut_nm?: number;
  label?: string;
  shift_nm?: number;
  crosstalk?: number | string | null;
  beyond?: string;
  answers?: { peak_qe?: number; level?: string; [key: string]: unknown };
}

export interface LightPart {
  illuminant?: string;
  level_lux?: number;
  beyond?: string;
  [key: string]: unknown;
}

export interface ExposurePart {
  equal?: string;
  time_ms?: number;
  saturate?: number;
  f_number?: number;
}

export interface PicturePart {
  cube: string;
  beyond?: string;
  denoise?: string | null;
  [key: string]: unknown;
}

export interface SweepPart {
  vary: string;
  first: number;
  last: number;
  quantity?: string;
  second?: { vary: string; first: number; last: number; points?: number } | null;
  [key: string]: unknown;
}

/** A study as a TOML file has it; defaults may be left away. */
export interface Study {
  light?: LightPart;
  exposure?: ExposurePart;
  sensors: SensorPart[];
  matrices?: string[];
  pictures?: PicturePart[];
  prior?: string | null;
  sweeps?: SweepPart[];
  outputs?: { reader?: string; [key: string]: unknown };
  seed?: number;
}

/** How a study is looked at. */
export interface Look {
  theme: string;
  coordinate: string;
  plane: string;
  turn: number[];
  magnification: Maybe;
  open: string[];
  /** Whether the exposure time is solved for again whenever something changes. */
  auto_exposure: boolean;
  /** The step of the tour, from 1. */
  story: Maybe;
}

export interface State {
  study: Study;
  look: Look;
}

/** Of a look, what the server needs to know. */
export type AskedLook = Pick<Look, "coordinate" | "plane" | "magnification">;

// ---- /api/choices -----------------------------------------------------------------------------

export interface Range {
  low: number;
  high: number;
  scale?: string;
  step?: number;
  /** Whether only whole numbers make sense. */
  whole?: boolean;
}

/** A slider of the study; a step of a logarithmic one is of log10. */
export interface Slider extends Range {
  key: string;
  label: string;
  unit: string;
}

/** The parameter of a color matrix. */
export interface Parameter extends Range {
  label: string;
  start: number;
}

/** One field of a study, from which a control is made. */
export interface Field extends Partial<Range> {
  key: string;
  section: string;
  /** Title of its drawer; "" for none. */
  group: string;
  label: string;
  what: string;
  kind: "number" | "choice" | "flag" | "text" | "channels";
  default: number | string | boolean | number[] | null;
  /** A key without which it has no effect. */
  needs: string[];
  unit?: string;
  options?: string[];
  suggestions?: string[];
  /** What stands in an empty field. */
  hint?: string;
  numeric?: boolean;
  many?: boolean;
  /** What a file in place of the value holds, and a table to begin with. */
  file?: string;
  example?: string;
}

export type PixelValues = Record<string, Maybe>;

export interface KnownSensor {
  name: string;
  what: string;
  channels: string[];
  origin: string;
  pitch_um: number;
  full_well_e: number;
  read_noise_e: number;
  pixel: PixelValues;
}

export interface KnownSweep {
  name: string;
  what: string;
  unit: string;
  first: number;
  last: number;
}

/** What is behind a `?`; formulas and symbols are MathML. */
export interface Explanation {
  title: string;
  words: string;
  formulas: string[];
  symbols: { symbol: string; meaning: string; unit: string }[];
  source: string;
}

/** A chart as a section: `shows` is its caption, `explanations` are keys of equations. */
export interface Section {
  part: Part;
  heading: string;
  shows: string;
  explanations: string[];
  /** Whether it needs two columns. */
  is_broad: boolean;
}

export interface Choices {
  version: string;
  /** In their order. */
  sections: Section[];
  study: Study;
  /** Whether `/api/front` has one. */
  front: boolean;
  sensors: KnownSensor[];
  illuminants: string[];
  /** Where the tables of illuminants end that need an answer to `light.beyond`. */
  illuminant_ends_nm: Record<string, number>;
  scenes?: string[];
  denoising: { name: string; what: string; needs: string[] }[];
  matrices: { name: string; parameter: Parameter | null }[];
  priors: string[];
  coordinates?: string[];
  sliders: Slider[];
  fields: Field[];
  /** Of a study, by key; none where the default is no value. */
  defaults: Record<string, string | number | boolean>;
  /** The largest numbers of entries in lists of a study, and the number of seeds. */
  most: { sensors: number; matrices: number; seeds: number };
  /** Words of infrared diodes beside a light; the first is the usual one. */
  infrared_lights: string[];
  hints?: Record<string, string>;
  sweeps: KnownSweep[];
  quantities: { name: string; what: string }[];
}

// ---- /api/story -------------------------------------------------------------------------------

/** A step of the tour: a state of the page, and what it shows. */
export interface StoryStep {
  heading: string;
  /** The panels that show it. */
  parts: Part[];
  sentences: string[];
  task: string;
  /** To the task, with its numbers. */
  answer: string;
  /** Key of the control that the task names, or empty. */
  control: string;
  study: Study;
  look: Partial<Look>;
}

export interface Story {
  steps: StoryStep[];
}

// ---- /api/answer: the parts -------------------------------------------------------------------

export interface HeadSensor {
  name: string;
  channels: string[];
  origin: string;
  time_ms: number;
  f_number: number;
  pitch_um: number;
  full_well_e: number;
  read_noise_e: number;
  pixel: PixelValues;
  saturated: string[];
  mean_e: Record<string, number>;
  notes?: string[];
}

/** Text as it is shown, of one length per row. */
export interface Table {
  head: string[];
  rows: string[][];
}

/** What every chart has: a title that names the operating point, a description, its table. */
interface Chartable {
  title: string;
  description: string;
  table: Table;
}

export interface Head {
  verdict: string[];
  light: { name: string; level_lux: number; text: string };
  sensors: HeadSensor[];
  table: Table;
  ranking: Ranking;
}

/** The table of the sensors: a column per key, and a row of values and of text per sensor. */
export interface Ranking {
  columns: RankingColumn[];
  rows: { name: string; values: Maybe[]; text: string[]; saturated: string[]; assumed: string }[];
  notes: string[];
}

export interface RankingColumn {
  key: string;
  head: string;
  what: string;
  better: "higher" | "lower" | null;
}

export interface Vector {
  at: number[];
  norm_share: number;
}

export interface Ellipsoid {
  center: number[];
  half_axes: number[][];
  norm_share?: number;
}

export interface VectorsSensor {
  name: string;
  channels: (Vector & { name: string })[];
  light: Vector | null;
  ellipsoid: Ellipsoid | null;
  magnification: number;
  why_not: string | null;
  note: string;
  description: string;
}

export interface VectorAxis {
  name: string;
  at: number[];
}

export interface Vectors {
  title: string;
  table: Table;
  axes: VectorAxis[];
  scene?: Vector | null;
  sigmas?: number;
  magnification: Maybe;
  sensors: VectorsSensor[];
}

/** What is drawn: the vectors are special. */
export type Drawn = Chart | Vectors;

/** Name of a drawn part. */
export type Part = string;

/** Drawn parts of one answer; `null` where there is nothing to show. */
export type Parts = Record<Part, Drawn | Failed | null | undefined>;

export interface Answer {
  number: number;
  hash?: string;
  seconds?: number;
  files?: Record<string, string>;
  parts: Record<Part, Drawn | Head | Failed | null | undefined>;
}

// ---- /api/picture and /api/upload -------------------------------------------------------------

export interface PictureSummary {
  sensor?: string;
  label?: string;
  width_px?: number;
  height_px?: number;
  above_full_well_share?: Record<string, number>;
  notes?: string[];
}

export interface FileQuestion {
  key: string;
  question: string;
  choices?: (string | number)[] | null;
}

interface UploadedPart {
  preview?: string[];
  asks?: FileQuestion[];
}

export interface UploadedStudy extends UploadedPart {
  kind: "study";
  study: Study;
}

/** What the id of a file stands for. */
export type FileKind = "sensor" | "light" | "cube" | "crosstalk" | "matrix" | "pixel" | "pairs";

export interface UploadedFile extends UploadedPart {
  kind: FileKind;
  id: string;
  /** What else the file may be, where it can be read in several ways. */
  others?: UploadedFile[];
}

export interface UploadedFront extends UploadedPart {
  kind: "front";
  front: Front;
}

export type Upload = UploadedStudy | UploadedFile | UploadedFront;

// ---- the front of a design --------------------------------------------------------------------

export interface FrontAxis {
  name: string;
  title: string;
  better: "higher" | "lower";
}

/** A reference, or a member, which has a mark. */
export interface FrontPoint {
  name: string;
  values: Record<string, Maybe>;
  text: Record<string, string>;
  reading: string;
  mark?: "member" | "extreme" | "knee";
  notes?: string[];
}

export interface FrontChart extends Chartable {
  x: string;
  y: string;
  axes: FrontAxis[];
  members: FrontPoint[];
  references: FrontPoint[];
  sentences: string[];
}

export interface FrontScene {
  name: string;
  light: LightPart;
  exposure: ExposurePart;
  matrix: string | null;
}

/** What loads a member: its file, and what of the study is its own. */
export interface FrontMember {
  file: string;
  text: string;
  pixel: Pixel;
  exposure: ExposurePart | null;
  matrix: string | null;
}

export interface Front {
  chart: FrontChart;
  scenes: FrontScene[];
  members: Record<string, FrontMember>;
}

// ---- what the drawing modules take and give ---------------------------------------------------

export interface Options<Data> {
  /** Earlier answers, drawn behind. */
  ghosts?: Data[];
  look?: Partial<Look> & { level_lux?: number; level?: string; divider?: number };
  width?: number;
  zoom?: number;
  home?: number[];
}

export interface DrawingModule<Data> {
  draw(element: HTMLElement, data: Data, options?: Options<Data>): void;
}

// ---- the data of a report ---------------------------------------------------------------------

export type ReportHead = Pick<Head, "verdict" | "table">;

export interface ReportSlide {
  label: string;
  own: number;
  texts: string[];
  /** By part, a change per position. */
  answers: Record<string, ReportChanges[string][]>;
}

/** By part: the keys that differ, or the whole part. */
export type ReportChanges = Record<string, { whole?: object }>;

export interface ReportData {
  parts: Record<string, object>;
  slides: ReportSlide[];
  /** By part, of the study itself, to full precision. */
  csv: Record<string, string>;
}
