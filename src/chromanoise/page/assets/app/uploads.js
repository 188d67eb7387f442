/** Files that were brought: which stand in the lists of sensors, lights and scenes. */

const brought = { sensor: new Map(), light: new Map(), cube: new Map() };

/** Remembers the file's own name for the id that the server gave. */
export function remember(kind, id, name) {
  brought[kind]?.set(id, name);
}

/** The files of one kind as [id, name] pairs for a list. */
export function uploaded(kind) {
  return [...brought[kind]].map(([id, name]) => [id, `${name} (your file)`]);
}
