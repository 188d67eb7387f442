/** A state as text for the address, and back: JSON in base64url. */

/** The state as the part of an address behind `#`. */
export function encoded(state) {
  const bytes = new TextEncoder().encode(JSON.stringify(state));
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** The state that such a text holds; throws an Error with one sentence where it holds none. */
export function decoded(text) {
  const state = json(text);
  const sensors = state?.study?.sensors;
  const named = Array.isArray(sensors) && sensors.length > 0;
  if (!named || !sensors.every((sensor) => typeof sensor?.name === "string")) {
    throw new Error("This link holds no study, so the default study is shown.");
  }
  return { study: state.study, look: isRecord(state.look) ? state.look : {} };
}

function json(text) {
  try {
    const plain = atob(text.replaceAll("-", "+").replaceAll("_", "/"));
    const bytes = Uint8Array.from(plain, (letter) => letter.charCodeAt(0));
    return JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes));
  } catch {
    throw new Error("This link is cut or mistyped, so the default study is shown.");
  }
}

/** Whether a value is a plain record of keys. */
export function isRecord(value) {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}
