/** A state as text for the address, and back: JSON in base64url. */

/** @import { Look, SensorPart, State, Study } from "answers" */

/**
 * The state as the part of an address behind `#`.
 *
 * @param {State} state
 */
export function encoded(state) {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/**
 * The state that such a text holds; throws an Error with one sentence where it holds none.
 *
 * @param {string} text
 * @returns {{ study: Study, look: Partial<Look> }}
 */
export function decoded(text) {
  const state = json(text);
  const sensors = state?.study?.sensors;
  if (!Array.isArray(sensors) || sensors.length === 0) {
    throw new Error("This link holds no study, so the default study is shown.");
  }
  const odd = Object.entries(KINDS).filter(([key, fits]) => !fits(state.study[key]));
  if (odd.length) {
    const keys = odd.map(([key]) => key).join(" and ");
    throw new Error(`This link holds ${keys} of another kind, so the default study is shown.`);
  }
  return { study: state.study, look: isRecord(state.look) ? state.look : {} };
}

/** @param {string} text */
function json(text) {
  try {
    const plain = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(plain, (letter) => letter.charCodeAt(0));
    return JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes));
  } catch {
    throw new Error("This link is cut or mistyped, so the default study is shown.");
  }
}

/** What the controls read must be of these kinds; what it says is the server's to judge. */
/** @type {Record<string, (value: unknown) => boolean>} */
const KINDS = {
  light: (light = {}) => isRecord(light) && isText(light.illuminant),
  exposure: (exposure = {}) => isRecord(exposure),
  sensors: (sensors) => Array.isArray(sensors) && sensors.every(isSensor),
  matrices: (names = []) => Array.isArray(names) && names.every((name) => typeof name === "string"),
  pictures: (pictures = []) => Array.isArray(pictures) && pictures.every((one) => isRecord(one) && isText(one.cube)),
  prior: isText,
};

/**
 * @param {unknown} sensor
 * @returns {sensor is SensorPart}
 */
function isSensor(sensor) {
  if (!isRecord(sensor) || typeof sensor.name !== "string") return false;
  return isText(sensor.filter) && [sensor.pixel, sensor.answers].every((table = {}) => isRecord(table));
}

/**
 * @param {unknown} value
 * @returns {value is string | null | undefined}
 */
function isText(value) {
  return value === undefined || value === null || typeof value === "string";
}

/**
 * Whether a value is a plain record of keys.
 *
 * @param {unknown} value
 * @returns {value is Record<string, any>}
 */
function isRecord(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
