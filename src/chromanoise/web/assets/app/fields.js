/** Rows of controls for the fields of a study, made from the descriptions that the server gives. */

import { Refused, sent, understood, UNHEARD } from "app/ask.js";
import { attribute, button, choice, drawer, el, fillChoice, say, square, uniqueId } from "app/dom.js";
import { complain } from "app/faults.js";
import { setAt, valueAt } from "app/paths.js";
import { shownUnit, slider } from "app/slider.js";
import { changeStudy } from "app/state.js";
import { learn, shownName } from "app/uploads.js";

/** @import { Choices, Field, Head, Range, Study, UploadedFile } from "answers" */
/** @typedef {(study: Study, head: Head | null) => void} Show */
/** @typedef {{ row: HTMLElement, show: Show }} Row */
/** @typedef {(value: unknown, how?: "step" | "slide") => void} Write */

const FLAGS = [["true", "yes"], ["false", "no"]];
/** Groups that matter only where a word of the study names a file. */
/** @type {Record<string, string>} */
const OF_FILES = { "File of the curves": "sensors.name", "File of the light": "light.illuminant" };
const IS_FILE = /upload:|\.[a-z]\w*$/i;

/**
 * The key in a study: with the number of the sensor, and of the first picture.
 *
 * @param {string} key
 * @param {number} i
 */
export const pathOf = (key, i) => key.replace(/^sensors\./, `sensors.${i}.`).replace(/^pictures\./, "pictures.0.");

/**
 * How many fields of one sensor the study sets to another value than the default.
 *
 * @param {Field[]} fields
 * @param {Study} study
 * @param {number} i
 */
export const countSet = (fields, study, i) => fields.filter((field) => {
  const value = valueAt(study, pathOf(field.key, i));
  return value !== null && value !== field.default;
}).length;

/**
 * All controls of a section: those without a group first, then a drawer for each group.
 *
 * @param {Choices} choices
 * @param {string} section
 * @param {number} [i] of the sensor
 * @returns {{ nodes: HTMLElement[], show: Show }}
 */
export function fieldGroups(choices, section, i = 0) {
  const own = choices.fields.filter((field) => field.section === section);
  const names = [...new Set(own.map(({ group }) => group))].sort((a, b) => Number(a !== "") - Number(b !== ""));
  const groups = names.map((name) => fieldGroup(choices, name, own.filter(({ group }) => group === name), i));
  return {
    nodes: groups.flatMap(({ nodes }) => nodes),
    show: (study, head) => groups.forEach((group) => group.show(study, head)),
  };
}

/**
 * @param {Choices} choices
 * @param {string} name
 * @param {Field[]} fields
 * @param {number} i
 * @returns {{ nodes: HTMLElement[], show: Show }}
 */
function fieldGroup(choices, name, fields, i) {
  const make = () => {
    const rows = fields.map((field) => fieldRow(choices, field, i));
    /** @type {Show} */
    const show = (study, head) => rows.forEach((row) => row.show(study, head));
    return { nodes: rows.map(({ row }) => row), show };
  };
  if (!name) return make();
  const paths = fields.map(({ key }) => pathOf(key, i));
  const closed = drawer(name, (path) => paths.some((one) => `${path}.`.startsWith(`${one}.`)), make);
  const file = OF_FILES[name] && pathOf(OF_FILES[name], i);
  /** @type {Show} */
  const show = (study, head) => {
    const count = countSet(fields, study, i);
    say(closed.aside, count ? `${count} set` : "");
    if (file) closed.node.hidden = !count && !IS_FILE.test(valueAt(study, file) ?? "");
    closed.show(study, head);
  };
  return { nodes: [closed.node], show };
}

/**
 * Whether a study has none of some keys.
 *
 * @param {Study} study
 * @param {string[]} keys
 * @param {number} i
 */
const absent = (study, keys, i) => keys.every((key) => valueAt(study, pathOf(key, i)) === null);

/**
 * @param {Choices} choices
 * @param {Field} field
 * @param {number} i
 * @returns {Row}
 */
function fieldRow(choices, field, i) {
  const path = pathOf(field.key, i);
  const idle = choices.fields.filter(({ needs }) => needs.includes(field.key));
  /** @type {Write} */
  const write = (value, how = "step") =>
    changeStudy((study) => {
      setAt(study, path, value);
      // what has no effect without this goes with it
      if (value !== null) return;
      for (const { key, needs } of idle) if (absent(study, needs, i)) setAt(study, pathOf(key, i), null);
    }, how);
  const { row, show } = MAKERS[field.kind](choices, field, i, write);
  const bar = field.file && field.kind !== "channels" ? fileBar(field, path, row, write) : null;
  if (bar) row.append(...bar.nodes);
  row.title = field.what;
  /** @type {Show} */
  const shown = (study, head) => {
    const value = valueAt(study, path);
    row.hidden = field.needs.length > 0 && value === null && absent(study, field.needs, i);
    if (row.hidden) return;
    show(study, head);
    bar?.show(value);
  };
  return { row, show: shown };
}

/** @type {Record<Field["kind"], (choices: Choices, field: Field, i: number, write: Write) => Row>} */
const MAKERS = { number: numberRow, choice: choiceRow, flag: choiceRow, text: textRow, channels: channelRows };

/**
 * @param {Choices} choices
 * @param {Field} field
 * @param {number} i
 * @param {Write} write
 * @returns {Row}
 */
function numberRow(choices, field, i, write) {
  const path = pathOf(field.key, i);
  const inPixel = field.key.startsWith("sensors.pixel.");
  const range = /** @type {Field & Range} */ (field);
  const control = slider({
    label: field.label,
    unit: shownUnit(field),
    range,
    where: path,
    own: inPixel ? "as built" : field.default === null ? "none" : "default",
    on: (value) => write(value, value === null ? "step" : "slide"),
  });
  const row = field.file ? el("div", { class: "row" }, control.row) : control.row;
  const untouched = field.key === "sensors.ircut_nm" ? range.high : Math.max(range.low, Math.min(0, range.high));
  /** @type {Show} */
  const show = (study, head) => {
    const value = valueAt(study, path);
    if (field.file) control.row.hidden = typeof value === "string";
    if (typeof value === "string") return;
    const built = inPixel ? asBuilt(choices, study, head, field.key, i) : /** @type {number | null} */ (field.default);
    control.show(value, built ?? untouched, built === null ? (field.hint ?? "none") : null, built);
  };
  return { row, show };
}

/**
 * A value of the sensor's pixel without those that the study sets; null where it is not known.
 *
 * @param {Choices} choices
 * @param {Study} study
 * @param {Head | null} head
 * @param {string} key
 * @param {number} i
 */
function asBuilt(choices, study, head, key, i) {
  const name = key.slice("sensors.pixel.".length);
  const { pixel = {}, ...sensor } = study.sensors[i];
  const known = pixel.file ? undefined : choices.sensors.find((one) => one.name === sensor.name)?.pixel;
  // values of the reply are those of binned pixels, and of what is set
  const told = pixel.binning || pixel[name] !== undefined ? undefined : head?.sensors?.[i]?.pixel;
  return (known ?? told)?.[name] ?? null;
}

/**
 * @param {Choices} _
 * @param {Field} field
 * @param {number} i
 * @param {Write} write
 * @returns {Row}
 */
function choiceRow(_, field, i, write) {
  const path = pathOf(field.key, i);
  const unset = String(field.default ?? "");
  const words = field.kind === "flag" ? FLAGS : (field.options ?? []).map((word) => [word, word]);
  const options = field.default === null ? [["", field.hint ?? "not given"], ...words] : words;
  const control = choice({
    label: field.label,
    options,
    where: path,
    on: (word) => write(word === unset ? null : field.kind === "flag" ? word === "true" : word),
  });
  /** @type {Show} */
  const show = (study) => {
    const word = String(valueAt(study, path) ?? unset);
    fillChoice(control.select, IS_FILE.test(word) ? [...options, [word, shownName(word)]] : options, word);
  };
  return { row: control.row, show };
}

/**
 * @param {Choices} _
 * @param {Field} field
 * @param {number} i
 * @param {Write} write
 * @returns {Row}
 */
function textRow(_, field, i, write) {
  const path = pathOf(field.key, i);
  const id = uniqueId("text");
  const offered = field.suggestions?.length
    ? el("datalist", { id: `${id}-known` }, ...field.suggestions.map((value) => el("option", { value })))
    : null;
  const asked = { type: "text", autocomplete: "off", spellcheck: "false", class: "word" };
  /** @type {HTMLInputElement} */
  const typed = el("input", {
    ...{ id, ...asked, list: offered?.id, "data-where": path },
    placeholder: field.hint ?? textOf(field.default),
    on: { change: () => write(valueOf(field, typed.value)) },
  });
  const row = el("div", { class: "row" }, el("label", { for: id, class: "label", text: field.label }), typed, offered);
  let shown = "";
  // an answer that comes while somebody types must not take the letters away
  /** @type {Show} */
  const show = (study) => {
    const text = textOf(valueAt(study, path));
    if (shown !== text) typed.value = shown = text;
  };
  return { row, show };
}

/** @param {unknown} value */
const textOf = (value) => (Array.isArray(value) ? value.join(", ") : value === null ? "" : shownName(String(value)));

/**
 * A typed word as a study has it: nothing, a number, a list of numbers, or the word.
 *
 * @param {Field} field
 * @param {string} text
 */
function valueOf({ numeric, many }, text) {
  const word = text.trim();
  if (word === "") return null;
  const numbers = (many ? word.split(/[\s,;]+/) : [word.replace(",", ".")]).map(Number);
  if (!numeric || !numbers.every(Number.isFinite)) return word;
  return many ? numbers : numbers[0];
}

/**
 * One text for each channel of a sensor.
 *
 * @param {Choices} choices
 * @param {Field} field
 * @param {number} i
 * @returns {Row}
 */
function channelRows(choices, field, i) {
  const row = el("div");
  /** @type {Row[]} */
  let rows = [];
  let made = "";
  /** @type {Show} */
  const show = (study, head) => {
    // a key of a study holds no dot
    const names = (head?.sensors?.[i]?.channels ?? []).filter((name) => !name.includes("."));
    if (names.join() !== made) {
      made = names.join();
      const each = names.map((name) => ({ ...field, key: `${field.key}.${name}`, label: `${field.label} ${name}` }));
      rows = each.map((one) => fieldRow(choices, { ...one, kind: "text" }, i));
      row.replaceChildren(...rows.map((one) => one.row));
    }
    for (const one of rows) one.show(study, head);
  };
  return { row, show };
}

/**
 * The file in place of a value: its name, and buttons that choose, type and remove it.
 *
 * @param {Field} field
 * @param {string} path
 * @param {HTMLElement} row
 * @param {Write} write
 */
function fileBar(field, path, row, write) {
  const name = el("span", { class: "file" });
  const of = `${field.label}${path.startsWith("sensors.") ? ` of sensor ${Number(path.split(".")[1]) + 1}` : ""}`;
  const away = square("\u00d7", "Remove", `Remove the file: ${of}`, () => write(null));
  const choose = button("Choose a file", () => chosen((file) => bring(field, row, file, write)), {
    ...{ class: "own", "aria-label": `Choose a file: ${of}` },
  });
  const typing = field.example ? typedFile(field, of, (file) => bring(field, row, file, write)) : [];
  const line = el("div", { class: "row-file" }, name, away, choose, ...typing);
  /** @param {unknown} value */
  const show = (value) => {
    const isFile = typeof value === "string" && IS_FILE.test(value);
    say(name, isFile ? shownName(value) : "");
    name.hidden = away.hidden = !isFile;
    attribute(away, "data-where", isFile ? path : null);
  };
  return { nodes: [line], show };
}

/** @param {(file: File) => void} take */
function chosen(take) {
  const input = el("input", { type: "file" });
  input.addEventListener("change", () => input.files?.[0] && take(input.files[0]));
  input.click();
}

/**
 * A file that is typed instead: a button, and the text that it opens.
 *
 * @param {Field} field
 * @param {string} of
 * @param {(file: File) => void} take
 */
function typedFile({ example = "", file }, of, take) {
  const text = el("textarea", { rows: 4, "aria-label": `${of}, as a table`, spellcheck: "false" });
  text.value = example;
  const use = button("Use", () => take(new File([text.value], `${file}.csv`)), { class: "own" });
  const form = el("div", { class: "typed", hidden: true }, text, use);
  const open = button("Type a table", () => ((form.hidden = !form.hidden), form.hidden || text.focus()), { class: "own" });
  return [open, form];
}

/**
 * Sends a file and puts it into the study, or says beside the control why not.
 *
 * @param {Field} field
 * @param {HTMLElement} row
 * @param {File} file
 * @param {Write} write
 */
async function bring(field, row, file, write) {
  try {
    const reply = await understood(await sent(file.name, file));
    if (!row.isConnected) return; // its sensor was removed meanwhile
    /** @type {UploadedFile[]} */
    const ways = [reply, ...(reply.others ?? [])];
    const fits = ways.find(({ kind }) => kind === field.file || (field.file === "spectrum" && SPECTRA.has(kind)));
    if (!fits) throw new Refused([{ sentence: `${file.name} is read as ${reply.kind}, not as ${field.file}.` }]);
    learn({ [fits.id]: file.name });
    complain(row, null);
    write(fits.id);
  } catch (error) {
    complain(row, error instanceof Refused ? error.message : UNHEARD);
  }
}

/** Tables of spectra are read as sensors and lights; a spectrum of few rows may also be a matrix. */
const SPECTRA = new Set(["sensor", "light", "pairs"]);
