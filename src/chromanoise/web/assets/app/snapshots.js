/** Earlier answers kept as ghosts behind the drawings: up to three, named, removable. */

import { posted, Refused, silence } from "app/ask.js";
import { brief, button, el } from "app/dom.js";
import { PARTS } from "app/panels.js";
import { saidAt } from "app/paths.js";
import { current } from "app/state.js";
import { shownName } from "app/uploads.js";

/** @import { AskedLook, Head, Look, Part, Parts, Study } from "answers" */
/** @typedef {{ study: Study, name: string, parts: Parts & { head?: Head }, turn: number }} Ghost */

const MOST = 3;

/**
 * Of a look, what the server needs to know.
 *
 * @param {Look} look
 * @returns {AskedLook}
 */
export function askedLook({ coordinate, plane, magnification }) {
  return { coordinate, plane, magnification };
}

/**
 * The row of ghosts in `place`; `changed()` is called when what stands behind the drawings changed.
 * Gives `ghosts(part, data)`, the earlier data that can stand behind these, `heads()`, the earlier
 * verdicts and tables, and `look()`, to be called when that changed.
 *
 * @param {HTMLElement} place
 * @param {() => void} changed
 */
export function snapshots(place, changed) {
  /** @type {Ghost[]} */
  let kept = [];
  let count = 0;
  const said = el("span", { class: "said", role: "status" });
  const list = el("ul", { class: "ghosts", "aria-label": "Pinned for comparison" });
  const keep = button("Pin for comparison", () => take(), { id: "keep", title: "Draw these results behind the next ones" });
  place.replaceChildren(keep, list, said);

  const take = async () => {
    count += 1;
    const { study } = current();
    const ghost = { study, name: `${count}: ${shortName(study)}`, parts: {}, turn: 0 };
    keep.disabled = true;
    said.textContent = await refreshed(ghost);
    if (said.textContent === "") kept = [...kept, ghost];
    show();
  };
  const show = () => {
    list.replaceChildren(...kept.map((ghost) => chip(ghost, drop)));
    keep.disabled = kept.length >= MOST;
    keep.title = keep.disabled ? "Limit: three pins; remove one first." : "";
    changed();
  };
  /** @param {Ghost} ghost */
  const drop = (ghost) => {
    kept = kept.filter((other) => other !== ghost);
    show();
    keep.focus();
  };
  const look = async () => {
    await Promise.all(kept.map(refreshed));
    if (kept.length) changed();
  };
  /**
   * @param {Part} part
   * @param {object | null} data
   */
  const ghosts = (part, data) => kept.map((ghost) => ghost.parts[part]).filter((old) => data && old && !("fault" in old));
  const heads = () => kept.flatMap(({ parts: { head } }) => (head?.ranking ? [head] : []));
  return { ghosts, heads, look };
}

/**
 * Asks for all parts of a ghost's study; gives a sentence where that failed, else "".
 *
 * @param {Ghost} ghost
 * @returns {Promise<string>}
 */
async function refreshed(ghost) {
  const look = askedLook(current().look);
  const want = ["head", ...PARTS.filter((part) => part !== "map")]; // which has no place for an earlier one
  const turn = (ghost.turn += 1);
  try {
    const reply = await posted("/api/answer", { number: 0, study: ghost.study, want, look });
    // a newer question about this ghost is under way, and its answer is the one that counts
    if (turn !== ghost.turn) return "";
    if (JSON.stringify(look) !== JSON.stringify(askedLook(current().look))) return refreshed(ghost);
    ghost.parts = reply.parts;
    return "";
  } catch (error) {
    return error instanceof Refused ? error.message : silence(", so nothing was pinned.");
  }
}

/** @param {Study} study */
function shortName(study) {
  const level = `${brief(saidAt(study, "light.level_lux"), 3)} lx ${shownName(saidAt(study, "light.illuminant"))}`;
  return `${level}, f/${brief(saidAt(study, "exposure.f_number"), 2)}, ${study.sensors.length} sensors`;
}

/**
 * @param {Ghost} ghost
 * @param {(ghost: Ghost) => void} drop
 */
function chip(ghost, drop) {
  const name = el("input", {
    type: "text",
    value: ghost.name,
    maxlength: "60",
    "aria-label": "Name of this pin",
    on: { input: () => rename() },
  });
  const away = button("\u00d7", () => drop(ghost), { class: "square", title: "Remove" });
  const rename = () => {
    ghost.name = name.value;
    away.setAttribute("aria-label", `Remove pin ${ghost.name}`);
  };
  rename();
  return el("li", { class: "chip" }, name, away);
}
