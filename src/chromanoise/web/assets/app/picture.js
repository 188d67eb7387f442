/** The panel of the noisy picture: two of them with a divider, fetched after the numbers. */

import { IS_FILE, Refused, reply, understood } from "app/ask.js";
import { attribute, brief, button, choice, el, fillChoice, say, within } from "app/dom.js";
import { most, saidAt } from "app/paths.js";
import { setDenoising } from "app/scene.js";
import { changeStudy, current } from "app/state.js";
import { shownName } from "app/uploads.js";
import { draw } from "draw/picture.js";

/** @import { Choices, PictureSummary, State, SensorPart, Study } from "answers" */
/** @typedef {{ blob: Blob, summary: PictureSummary }} TakenPicture */

const REST_MS = 350;
/** Unseen it comes too, for it may be printed, but once nobody waits for anything else. */
const UNSEEN_REST_MS = 4000;
const BUSY = ".panel[aria-busy]:not([data-part=picture])";
const SIDES = ["Left", "Right"];
/** The zoom to begin with: in narrow windows as wide as there is room. */
const ZOOMS = [["(max-width: 899px)", "0"], ["(min-width: 2560px)", "2"]];
const NO_METHOD = ["", "none"];
/** So long a wait is not told. */
const SLOW_MS = 2000;
/** Before a request that was lost is repeated. */
const AGAIN_MS = 1000;
const MAKING = "The picture is being made.";
const FIRST =
  "If numerical code must be compiled for this processor, this takes about a minute, once.";

/**
 * Fills the panel; gives `later(state)`, which fetches once nothing has moved for a while.
 *
 * @param {Choices} choices
 */
export function picturePanel(choices) {
  const section = within(document, 'section[data-part="picture"]');
  const view = new View(section, choices);
  const watcher = new IntersectionObserver(([entry]) => view.see(entry.isIntersecting));
  watcher.observe(section);
  return /** @param {State} state */ (state) => view.later(state);
}

class View {
  /** @type {number | undefined} */
  #waiting;
  /** @type {number | undefined} */
  #slow;
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
  /** Whether the study has a method, and the sides from before it had one. */
  #denoises = false;
  /** @type {string[]} */
  #sidesBefore = [];

  /**
   * @param {HTMLElement} section
   * @param {Choices} choices
   */
  constructor(section, { denoising }) {
    this.section = section;
    this.methods = denoising;
    this.body = within(section, ".body");
    this.said = el("p", { class: "hint", role: "status" });
    this.sides = SIDES.map((label) => choice({ label, options: [], on: () => this.later(current()) }));
    this.zoom = choice({
      label: "Zoom",
      options: [["0", "fit"], ...[1, 2, 4].map((times) => [String(times), `${times}:1`])],
      value: ZOOMS.find(([media]) => window.matchMedia(media).matches)?.[1] ?? "1",
      on: () => this.#drawn(),
    });
    this.method = choice({
      label: "Denoising",
      options: [],
      where: "pictures.0.denoise",
      on: (name) => changeStudy((study) => setDenoising(study, name || null)),
    });
    const draws = button("New noise sample", () => changeStudy(nextSeed), { class: "plain" });
    this.seed = el("span", { class: "aside" });
    const tools = [this.method, ...this.sides, this.zoom].map((one) => one.row);
    section.insertBefore(el("div", { class: "picture-tools" }, ...tools, draws, this.seed), this.body);
    this.what = el("p", { class: "aside", hidden: true });
    section.append(this.what, this.said);
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
    this.#rest();
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
   * What can stand on each side: every sensor, with its noise, denoised, and without noise.
   *
   * @param {Study} study
   */
  #offer(study) {
    const { sensors } = study;
    const method = methodOf(study);
    const kinds = method ? ["noisy", "denoised", "still"] : ["noisy", "still"];
    const values = sensors.flatMap((_, i) => kinds.map((kind) => `${i} ${kind}`));
    const options = values.map((value) => [value, sideName(study, value)]);
    const wanted = this.#wantedSides(Boolean(method), sensors.length);
    this.sides.forEach(({ select }, side) => {
      const first = wanted[side].replace(/^\d+/, "0");
      fillChoice(select, options, values.includes(wanted[side]) ? wanted[side] : first);
    });
    const known = this.methods.map(({ name, needs }) =>
      needs.length ? [name, `${name}: needs ${needs.join(", ")}`, "disabled"] : [name, name],
    );
    fillChoice(this.method.select, [NO_METHOD, ...known], method ?? "");
    this.method.row.hidden = !method && known.length === 0;
    this.#describe(method);
    say(this.seed, `seed ${saidAt(study, "seed")}`);
  }

  /**
   * The values of both sides. With a method they are one sensor before and after it; without it
   * they become again what they were.
   *
   * @param {boolean} denoises
   * @param {number} count of sensors
   */
  #wantedSides(denoises, count) {
    const second = count > 1 ? "1 noisy" : "0 still";
    const now = this.sides.map(({ select }, side) => select.value || (side ? second : "0 noisy"));
    if (denoises === this.#denoises) return now;
    this.#denoises = denoises;
    if (!denoises) return this.#sidesBefore;
    this.#sidesBefore = now;
    const [sensor] = now[0].split(" ");
    return [`${sensor} noisy`, `${sensor} denoised`];
  }

  /** @param {string | null} method */
  #describe(method) {
    const known = this.methods.find(({ name }) => name === method);
    this.what.hidden = !known;
    if (known) say(this.what, `Denoising (${known.name}): ${sentence(known.what)} ${ITS_NOISE}`);
  }

  /**
   * @param {Study} study
   * @param {boolean} [again] whether a request that is lost is repeated
   * @returns {Promise<void>}
   */
  async #fetch(study, again = true) {
    if (again && !this.#visible && document.querySelector(BUSY)) return this.later({ study });
    this.#abort = new AbortController();
    const { signal } = this.#abort;
    // what was asked for, not what the choices say once it has come
    const [key, labels] = [this.#key(study), this.#labels(study)];
    const sides = this.sides.map(({ select }) => select.value);
    this.#asked = key;
    this.#slow = setTimeout(() => this.#tellSlow(), SLOW_MS);
    try {
      const pictures = await this.#pictures(study, sides, labels, signal);
      this.#shown = key;
      this.#told = summed(pictures.map(({ summary }) => summary));
      this.#replace(pictures.map(({ blob }) => URL.createObjectURL(blob)), labels);
      say(this.said, this.#told);
    } catch (error) {
      if (signal.aborted) return;
      if (again && isPassing(error)) {
        await new Promise((wait) => setTimeout(wait, AGAIN_MS));
        if (signal.aborted) return;
        this.#rest();
        return this.#fetch(study, false);
      }
      const lost = "Loading the picture failed; it will be retried after the next change.";
      say(this.said, error instanceof Refused ? error.message : lost);
    }
    this.#rest();
    attribute(this.section, "aria-busy", null);
  }

  /** Nothing is asked for any more. */
  #rest() {
    this.#asked = null;
    this.#markDenoising(null);
    clearTimeout(this.#slow);
    attribute(this.section, "data-making", null);
  }

  /** Says that a picture takes long, unless the denoised one is told about already. */
  #tellSlow() {
    if (this.section.hasAttribute("data-denoising")) return;
    attribute(this.section, "data-making", true);
    say(this.said, this.#pair || IS_FILE ? MAKING : `${MAKING} ${FIRST}`);
  }

  /**
   * The pictures of both sides. One that is not denoised comes first, and stands on both sides
   * until the other one has come.
   *
   * @param {Study} study
   * @param {string[]} sides
   * @param {string[]} labels
   * @param {AbortSignal} signal
   */
  async #pictures(study, sides, labels, signal) {
    const first = sides.map((side) => (isDenoised(side) ? null : picture(study, side, signal)));
    const come = await Promise.all(first);
    const at = come.findIndex(Boolean);
    const missing = come.indexOf(null);
    if (at >= 0 && missing >= 0) {
      const address = URL.createObjectURL(/** @type {TakenPicture} */ (come[at]).blob);
      this.#shown = null;
      this.#replace([address, address], [labels[at], labels[at]]);
      this.#markDenoising(SIDES[missing]);
      say(this.said, "Denoising \u2026");
    }
    return Promise.all(come.map((one, i) => one ?? picture(study, sides[i], signal)));
  }

  /**
   * Marks the side whose denoised picture is awaited.
   *
   * @param {string | null} side
   */
  #markDenoising(side) {
    attribute(this.section, "data-denoising", side && side.toLowerCase());
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
 * Whether the same request may succeed a moment later.
 *
 * @param {unknown} error
 */
function isPassing(error) {
  return !(error instanceof Refused);
}

const ITS_NOISE = "It uses the noise variance of this exposure.";

/** @param {Study} study */
function methodOf(study) {
  return study.pictures?.[0]?.denoise ?? null;
}

/** @param {string} side */
function isDenoised(side) {
  return side.endsWith(" denoised");
}

/** @type {Record<string, (study: Study) => string>} */
const KINDS = {
  noisy: () => "noisy",
  denoised: (study) => `denoised (${methodOf(study)})`,
  still: () => "without noise",
};

/**
 * What stands on a side: a sensor, with its noise, denoised, or without noise.
 *
 * @param {Study} study
 * @param {string} side
 */
function sideName(study, side) {
  const [sensor, kind] = side.split(" ");
  return `${sensorName(study.sensors, Number(sensor))}, ${KINDS[kind](study)}`;
}

/**
 * The label of a sensor, or its name, which gets a number where it stands there twice, as in a run.
 *
 * @param {SensorPart[]} sensors
 * @param {number} i
 */
function sensorName(sensors, i) {
  const { name, label } = sensors[i];
  if (label) return label;
  const before = sensors.slice(0, i).filter((other) => other.name === name).length;
  return before ? `${shownName(name)} (${before + 1})` : shownName(name);
}

/**
 * What the server tells of pictures, each once: their size, what does not fit into the pixel, the
 * notes. Notes on a sensor stand with the sensors.
 *
 * @param {PictureSummary[]} summaries
 */
function summed(summaries) {
  const sizes = summaries.flatMap(({ width_px, height_px }) => (width_px ? [`${width_px} \u00d7 ${height_px} pixels.`] : []));
  const over = summaries.flatMap(({ sensor, label = sensor, above_full_well_share: shares = {} }) => {
    const told = Object.entries(shares).flatMap(([name, share]) => (share > 0 ? [`${name} ${brief(100 * share, 2)} %`] : []));
    return told.length ? [`${label}, above full well: ${told.join(", ")}.`] : [];
  });
  const notes = summaries.flatMap((one) => one.notes ?? []).map(sentence);
  return [...new Set([...sizes, ...over, ...notes])].join(" ");
}

/**
 * Text with the capital letter and the full stop that it may lack.
 *
 * @param {string} text
 */
function sentence(text) {
  const begun = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(begun) ? begun : `${begun}.`;
}

/** @param {Study} study */
function nextSeed(study) {
  study.seed = (saidAt(study, "seed") + 1) % most.seeds;
}

/**
 * @param {Study} study
 * @param {string} side
 * @param {AbortSignal} signal
 * @returns {Promise<TakenPicture>}
 */
async function picture(study, side, signal) {
  const [sensor, kind] = side.split(" ");
  const asked = structuredClone(study);
  if (!isDenoised(side)) setDenoising(asked, null);
  // no cube is named: it is that of the study's own first picture, with all that it says of it
  const question = { study: asked, sensor: Number(sensor), noisy: kind !== "still", cube: null };
  const taken = await reply("/api/picture", question, signal);
  if (taken.ok && taken.headers.get("Content-Type")?.startsWith("image/")) {
    const summary = taken.headers.get("X-Chromanoise-Summary");
    return { blob: await taken.blob(), summary: summary ? JSON.parse(summary) : {} };
  }
  await understood(taken);
  throw new Refused([{ where: "", sentence: "No picture available." }]);
}
