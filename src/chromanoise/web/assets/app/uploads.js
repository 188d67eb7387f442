/** Files that were brought: which stand in the lists of sensors, lights and scenes. */

/** @import { FileKind } from "answers" */

const ID = /upload:[0-9a-f]{16}(?:\.[a-z0-9]+)?/g;
/** @type {Record<FileKind, Map<string, string[]>>} */
const brought = {
  ...{ sensor: new Map(), light: new Map(), cube: new Map() },
  ...{ crosstalk: new Map(), matrix: new Map(), pixel: new Map(), pairs: new Map() },
};
/** @type {Map<string, string>} */
const labels = new Map();

/**
 * Remembers, for the id that the server gave, the file's own name and the keys of what it asks.
 *
 * @param {FileKind} kind
 * @param {string} id
 * @param {string} label
 * @param {string[]} asks
 */
export function remember(kind, id, label, asks) {
  labels.set(id, label);
  brought[kind].set(id, asks);
}

/**
 * Takes the names of files that the server knows; tells whether one of them is new.
 *
 * @param {Record<string, string>} [files]
 */
export function learn(files = {}) {
  const fresh = Object.entries(files).filter(([id]) => !labels.has(id));
  for (const [id, label] of fresh) labels.set(id, label);
  return fresh.length > 0;
}

/**
 * A word of a study as people know it: the file's own name in place of the id of an upload.
 *
 * @param {string} word
 */
export function shownName(word) {
  return word.replace(ID, (id) => labels.get(id) ?? "a dropped file");
}

/**
 * Whether a file leaves this open: its level, its highest QE ...
 *
 * @param {FileKind} kind
 * @param {string} id
 * @param {string} key
 */
export function asksFor(kind, id, key) {
  return brought[kind].get(id)?.includes(key) ?? false;
}

/**
 * The files of one kind as [id, name] pairs for a list; `now` may be one that a link brought.
 *
 * @param {FileKind} kind
 * @param {string} [now]
 * @returns {string[][]}
 */
export function uploaded(kind, now = "") {
  const ids = new Set([...brought[kind].keys(), ...(now.match(ID) ?? [])]);
  return [...ids].map((id) => [id, labels.has(id) ? `${labels.get(id)} (your file)` : "a file that was dropped elsewhere"]);
}
