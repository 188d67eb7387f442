/** A state as text for the address, and back: JSON in base64url. */

/** @import { Look, PicturePart, SensorPart, State, Study } from "answers" */

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
  light: (light) => unsaid(light) || (isRecord(light) && isText(light.illuminant)),
  exposure: (exposure) => unsaid(exposure) || isRecord(exposure),
  sensors: (sensors) => Array.isArray(sensors) && sensors.every(isSensor),
  matrices: (names) => unsaid(names) || (Array.isArray(names) && names.every((name) => typeof name === "string")),
  pictures: (pictures) => unsaid(pictures) || (Array.isArray(pictures) && pictures.every(isPicture)),
  prior: isText,
};

/**
 * @param {unknown} sensor
 * @returns {sensor is SensorPart}
 */
function isSensor(sensor) {
  if (!isRecord(sensor) || typeof sensor.name !== "string") return false;
  const tables = [sensor.pixel, sensor.answers];
  return isText(sensor.filter) && tables.every((table) => unsaid(table) || isRecord(table));
}

/**
 * @param {unknown} picture
 * @returns {picture is PicturePart}
 */
function isPicture(picture) {
  return isRecord(picture) && isText(picture.cube);
}

/**
 * @param {unknown} value
 * @returns {value is undefined}
 */
function unsaid(value) {
  return value === undefined;
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
export function isRecord(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
