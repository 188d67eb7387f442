/** The panel of the noisy picture: two of them with a divider, fetched after the numbers. */

import { Refused } from "app/ask.js";
import { attribute, brief, button, choice, el, fillChoice, say, within } from "app/dom.js";
import { changeStudy, current } from "app/state.js";
import { shownName } from "app/uploads.js";
import { draw } from "draw/picture.js";

/** @import { PictureSummary, State, SensorPart, Study } from "answers" */
/** @typedef {{ blob: Blob, summary: PictureSummary }} TakenPicture */

const REST_MS = 350;
/** Unseen it comes too, for it may be printed, but once nobody waits for anything else. */
const UNSEEN_REST_MS = 4000;
const BUSY = ".panel[aria-busy]:not([data-part=picture])";
const SIDES = ["Left", "Right"];

/** Fills the panel; gives `later(state)`, which fetches once nothing has moved for a while. */
export function picturePanel() {
  const section = within(document, 'section[data-part="picture"]');
  const view = new View(section);
  const watcher = new IntersectionObserver(([entry]) => view.see(entry.isIntersecting));
  watcher.observe(section);
  return /** @param {State} state */ (state) => view.later(state);
}

class View {
  /** @type {number | undefined} */
  #waiting;
  /** @type {AbortController | null} */
  #abort = null;
  /** @type {string | null} */
  #asked = null;
  /** @type {string | null} */
  #shown = null;
  #told = "";
  #visible = false;
  /** @type {{ addresses: string[], labels: string[] } | null} */
  #pair = null;

  /** @param {HTMLElement} section */
  constructor(section) {
    this.section = section;
    this.body = within(section, ".body");
    this.said = el("p", { class: "hint", role: "status" });
    this.sides = SIDES.map((label) => choice({ label, options: [], on: () => this.later(current()) }));
    this.zoom = choice({
      label: "Zoom",
      options: [1, 2, 4].map((times) => [String(times), `${times}:1`]),
      on: () => this.#drawn(),
    });
    const draws = button("New noise sample", () => changeStudy(nextSeed), { class: "plain" });
    this.seed = el("span", { class: "aside" });
    const tools = [...this.sides, this.zoom].map((one) => one.row);
    section.insertBefore(el("div", { class: "picture-tools" }, ...tools, draws, this.seed), this.body);
    section.append(this.said);
  }

  /** @param {boolean} visible */
  see(visible) {
    this.#visible = visible;
    if (visible) this.later(current());
  }

  /** @param {{ study: Study }} state */
  later({ study }) {
    this.#offer(study);
    const key = this.#key(study);
    if (key === this.#asked) return;
    // what is under way belongs to an earlier state
    this.#abort?.abort();
    this.#asked = null;
    clearTimeout(this.#waiting);
    const here = key === this.#shown;
    attribute(this.section, "aria-busy", here ? null : "true");
    if (here) say(this.said, this.#told);
    else this.#waiting = setTimeout(() => this.#fetch(study), this.#visible ? REST_MS : UNSEEN_REST_MS);
  }

  /**
   * What the pictures of a study depend on, names of files that come later included.
   *
   * @param {Study} study
   */
  #key(study) {
    return JSON.stringify([study, this.sides.map(({ select }) => select.value), this.#labels(study)]);
  }

  /** @param {Study} study */
  #labels(study) {
    return this.sides.map(({ select }) => sideName(study, select.value));
  }

  /**
   * What can stand on each side: every sensor, with its noise and without.
   *
   * @param {Study} study
   */
  #offer({ sensors, seed = 0 }) {
    const kinds = sensors.flatMap((_, i) => [`${i} noisy`, `${i} still`]);
    const options = kinds.map((value) => [value, sideName({ sensors }, value)]);
    this.sides.forEach(({ select }, side) => {
      const here = select.value || `${side} noisy`;
      const held = options.some(([value]) => value === here) ? here : options[0][0];
      fillChoice(select, options, held);
    });
    say(this.seed, `seed ${seed}`);
  }

  /** @param {Study} study */
  async #fetch(study) {
    if (!this.#visible && document.querySelector(BUSY)) return this.later({ study });
    this.#abort = new AbortController();
    const { signal } = this.#abort;
    // what was asked for, not what the choices say once it has come
    const [key, labels] = [this.#key(study), this.#labels(study)];
    this.#asked = key;
    try {
      const asked = this.sides.map(({ select }) => picture(study, select.value, signal));
      const pictures = await Promise.all(asked);
      this.#shown = key;
      this.#told = [...new Set(pictures.flatMap(summed))].join(" ");
      this.#replace(pictures.map(({ blob }) => URL.createObjectURL(blob)), labels);
      say(this.said, this.#told);
    } catch (error) {
      if (signal.aborted) return;
      const lost = "Loading the picture failed; it will be retried after the next change.";
      say(this.said, error instanceof Refused ? error.message : lost);
    }
    this.#asked = null;
    attribute(this.section, "aria-busy", null);
  }

  /**
   * @param {string[]} addresses
   * @param {string[]} labels
   */
  #replace(addresses, labels) {
    const old = this.#pair?.addresses ?? [];
    this.#pair = { addresses, labels };
    this.#drawn();
    setTimeout(() => old.forEach((address) => URL.revokeObjectURL(address)), 1000);
  }

  #drawn() {
    if (!this.#pair) return;
    const { addresses, labels } = this.#pair;
    const [left, right] = addresses;
    draw(this.body, { left, right, labels }, { zoom: Number(this.zoom.select.value), look: current().look });
  }
}

/**
 * What stands on a side: a sensor, with its noise or without.
 *
 * @param {Pick<Study, "sensors">} study
 * @param {string} side
 */
function sideName({ sensors }, side) {
  const [sensor, kind] = side.split(" ");
  return `${sensorName(sensors, Number(sensor))}, ${kind === "noisy" ? "noisy" : "without noise"}`;
}

/**
 * The sensor as people know it; one that stands there twice gets a number, as in a run.
 *
 * @param {SensorPart[]} sensors
 * @param {number} i
 */
function sensorName(sensors, i) {
  const { name } = sensors[i];
  const before = sensors.slice(0, i).filter((other) => other.name === name).length;
  return before ? `${shownName(name)} (${before + 1})` : shownName(name);
}

/**
 * What the server tells of a picture: its size, what does not fit into the pixel, its notes.
 *
 * @param {TakenPicture} picture
 */
function summed({ summary }) {
  const notes = (summary.notes ?? []).map((note) => (/[.!?]$/.test(note) ? note : `${note}.`));
  if (!summary.width_px) return notes;
  const size = `${summary.sensor}: ${summary.width_px} \u00d7 ${summary.height_px} pixels`;
  const over = Object.entries(summary.above_full_well_share ?? {}).filter(([, share]) => share > 0);
  const told = over.map(([name, share]) => `${name} ${brief(100 * share, 2)} %`);
  return [told.length ? `${size}, above full well ${told.join(", ")}.` : `${size}.`, ...notes];
}

/** @param {Study} study */
function nextSeed(study) {
  study.seed = ((study.seed ?? 0) + 1) % 2 ** 32;
}

/**
 * @param {Study} study
 * @param {string} side
 * @param {AbortSignal} signal
 * @returns {Promise<TakenPicture>}
 */
async function picture(study, side, signal) {
  const [sensor, kind] = side.split(" ");
  const reply = await fetch("/api/picture", {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    // no cube is named: it is that of the study's own first picture, with all that it says of it
    body: JSON.stringify({ study, sensor: Number(sensor), noisy: kind === "noisy", cube: null }),
    signal,
  });
  if (reply.ok && reply.headers.get("Content-Type")?.startsWith("image/")) {
    const summary = reply.headers.get("X-Chromanoise-Summary");
    return { blob: await reply.blob(), summary: summary ? JSON.parse(summary) : {} };
  }
  const told = await reply.json().catch(() => null);
  const faults = told?.faults?.length ? told.faults : [{ where: "", sentence: "No picture available." }];
  throw new Refused(faults);
}
