/** Values of a study by their key, as `light.level_lux` or `sensors.0.pixel.read_noise_e`. */

/** @import { Choices, Slider, Study } from "answers" */

/**
 * The value, or null where the study leaves it away.
 *
 * @param {object} study
 * @param {string} path
 * @returns {any}
 */
export function valueAt(study, path) {
  /** @type {any} */
  let value = study;
  for (const key of path.split(".")) value = value?.[key];
  return value ?? null;
}

/**
 * Writes a value, making the tables on the way; `null` takes the key away, and tables left empty.
 *
 * @param {object} study
 * @param {string} path
 * @param {unknown} value
 */
export function setAt(study, path, value) {
  const table = /** @type {Record<string, any>} */ (study);
  const [key, ...rest] = path.split(".");
  if (rest.length && (value !== null || table[key])) {
    setAt((table[key] ??= /^\d+$/.test(rest[0]) ? [] : {}), rest.join("."), value);
    if (isEmpty(table[key]) && !Array.isArray(table)) delete table[key];
  } else if (value === null) delete table[key];
  else table[key] = value;
}

/** @param {object} table */
const isEmpty = (table) => (Array.isArray(table) ? table.every(isEmpty) : Object.keys(table).length === 0);

/** @type {Choices["defaults"]} */
const defaults = {};

/** The largest numbers of sensors and matrices, and the number of seeds; the server sets them. */
export const most = { sensors: 0, matrices: 0, seeds: 0 };

/**
 * Takes the defaults and the limits of a study from the server.
 *
 * @param {Choices} choices
 */
export function useDefaults(choices) {
  Object.assign(defaults, choices.defaults);
  Object.assign(most, choices.most);
}

/**
 * The default of a value; null where a study has none.
 *
 * @param {string} path
 * @returns {any}
 */
export function defaultOf(path) {
  return defaults[path.replace(/\.\d+/g, "")] ?? null;
}

/**
 * The value with the defaults of a study.
 *
 * @param {Study} study
 * @param {string} path
 * @returns {any}
 */
export function saidAt(study, path) {
  return valueAt(study, path) ?? defaultOf(path);
}

/**
 * A slider's range, as the server tells.
 *
 * @param {Choices} choices
 * @param {string} key
 * @returns {Omit<Slider, "key"> | null}
 */
export function rangeOf(choices, key) {
  const field = choices.fields.find((one) => one.key === key);
  return choices.sliders?.find((one) => one.key === key) ?? /** @type {Slider | undefined} */ (field) ?? null;
}
