/** Files that were brought: which stand in the lists of sensors, lights and scenes. */

const brought = { sensor: new Map(), light: new Map(), cube: new Map() };

/** Remembers, for the id that the server gave, the file's own name and the keys of what it asks. */
export function remember(kind, id, label, asks) {
  brought[kind]?.set(id, { label, asks });
}

/** A name as people know it: the file's own for the id of an upload. */
export function shownName(kind, name) {
  return brought[kind].get(name)?.label ?? name;
}

/** Whether a file leaves this open: its level, its highest QE ... */
export function asksFor(kind, id, key) {
  return brought[kind].get(id)?.asks.includes(key) ?? false;
}

/** The files of one kind as [id, name] pairs for a list. */
export function uploaded(kind) {
  return [...brought[kind]].map(([id, { label }]) => [id, `${label} (your file)`]);
}
