/** A chart as one description, written from chromanoise.charts.description by
 * tools/make_types.py. Nothing of this file is shipped. */

import type { Table } from "answers";

export interface Chart {
  title: string;
  description: string;
  sensors: string[];
  columns: Column[];
  panels: Panel[];
  whole_rows: boolean;
  named: "ends" | "legend";
  numbered: string[];
  notes: string[];
  without_numbers: number[];
  table: Table;
}

export interface Column {
  head: string | null;
  shown: string | null;
  values: (number | string | null)[];
}

export interface Panel {
  x: Axis;
  y: Axis;
  marks: (Line | Point | Ellipses | Area | Band | Rule)[];
  sensor: number | null;
  equal: boolean;
  better: string;
  remark: string;
  absence: string;
}

export interface Axis {
  label: string;
  low: number;
  high: number;
  logarithmic: boolean;
  exact: boolean;
  zero: boolean;
}

export interface Line {
  x: number;
  y: number;
  first: number;
  last: number;
  name: string;
  sensor: number;
  matrix: number;
  channel: string;
  texts: string[];
  kind: "line";
}

export interface Point {
  x: number;
  y: number;
  row: number;
  text: string;
  sensor: number;
  kind: "point";
}

export interface Ellipses {
  truth: [number, number];
  center: [number, number];
  half_axes: [number, number, number, number];
  reach: number;
  first: number;
  last: number;
  colors: string[];
  kind: "ellipses";
}

export interface Area {
  x: number;
  y: number;
  first: number;
  last: number;
  name: string;
  kind: "area";
}

export interface Band {
  low: number;
  name: string;
  kind: "band";
}

export interface Rule {
  at: number;
  role: "now" | "crossing";
  text: string;
  height: number | null;
  kind: "rule";
}
