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
  marks: (Line | Point | Cloud | Ellipses | Area | Band | Rule | Bars | Dots | Swatches | Cells)[];
  x: Axis;
  y: Axis;
  title: string;
  remark: string;
  explanation: string;
  description: string;
  sensor: number | null;
  equal: boolean;
  better: string;
  absence: string;
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

export interface Cloud {
  x: number;
  y: number;
  first: number;
  last: number;
  name: string;
  kind: "cloud";
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

export interface Bars {
  label: number;
  start: number;
  end: number;
  first: number;
  last: number;
  roles: ("total" | "cost" | "gain")[];
  texts: string[];
  kind: "bars";
}

export interface Dots {
  label: number;
  values: number[];
  first: number;
  last: number;
  kind: "dots";
}

export interface Swatches {
  colors: string[];
  sensor: number | null;
  texts: [string, string][];
  name: string;
  kind: "swatches";
}

export interface Cells {
  x: number;
  y: number;
  value: number;
  across: number;
  name: string;
  low: number;
  high: number;
  colors: string[];
  names: string[];
  equal: [number, number][][];
  kind: "cells";
}

export interface Axis {
  label: string;
  low: number;
  high: number;
  logarithmic: boolean;
  exact: boolean;
  zero: boolean;
}
