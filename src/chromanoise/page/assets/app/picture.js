/** The panel of the noisy picture: two of them with a divider, fetched after the numbers. */

import { Refused } from "app/ask.js";
import { brief, button, choice, el, fillChoice, say } from "app/dom.js";
import { cubeOf } from "app/scene.js";
import { changeStudy, current } from "app/state.js";
import { draw } from "draw/picture.js";

const REST_MS = 350;
const SIDES = ["Left", "Right"];

/** Fills the panel; gives `later(state)`, which fetches once nothing has moved for a while. */
export function picturePanel() {
  const section = document.querySelector('section[data-part="picture"]');
  const view = new View(section);
  const watcher = new IntersectionObserver(([entry]) => view.see(entry.isIntersecting));
  watcher.observe(section);
  return (state) => view.later(state);
}

class View {
  #waiting = null;
  #abort = null;
  #shown = null;
  #visible = false;
  #addresses = [];

  constructor(section) {
    this.section = section;
    this.body = section.querySelector(".body");
    this.said = el("p", { class: "hint", role: "status" });
    this.sides = SIDES.map((label) => choice({ label, options: [], on: () => this.#again() }));
    this.zoom = choice({
      label: "Zoom",
      options: [1, 2, 4].map((times) => [String(times), `${times}:1`]),
      on: () => this.#drawn(),
    });
    const draws = button("Draw the noise again", () => changeStudy(nextSeed), { class: "plain" });
    this.seed = el("span", { class: "aside" });
    const tools = [...this.sides, this.zoom].map((one) => one.row);
    section.insertBefore(el("div", { class: "picture-tools" }, ...tools, draws, this.seed), this.body);
    section.append(this.said);
  }

  see(visible) {
    this.#visible = visible;
    if (visible) this.later(current());
  }

  later(state) {
    this.#offer(state.study);
    clearTimeout(this.#waiting);
    this.#waiting = setTimeout(() => this.#fetch(state.study), REST_MS);
  }

  /** What can stand on each side: every sensor, with its noise and without. */
  #offer({ sensors, seed = 0 }) {
    const options = sensors.flatMap((sensor, i) => [
      [`${i} noisy`, `${sensor.name}, noisy`],
      [`${i} still`, `${sensor.name}, without noise`],
    ]);
    this.sides.forEach(({ select }, side) => {
      const here = select.value || `${side} noisy`;
      const held = options.some(([value]) => value === here) ? here : options[0][0];
      fillChoice(select, options, held);
    });
    say(this.seed, `seed ${seed}`);
  }

  #again() {
    this.#shown = null;
    this.later(current());
  }

  async #fetch(study) {
    const key = JSON.stringify([study, ...this.sides.map(({ select }) => select.value)]);
    if (!this.#visible || key === this.#shown) return;
    this.#abort?.abort();
    this.#abort = new AbortController();
    const { signal } = this.#abort;
    try {
      const asked = this.sides.map(({ select }) => picture(study, select.value, signal));
      const pictures = await Promise.all(asked);
      this.#shown = key;
      this.#replace(pictures.map(({ blob }) => URL.createObjectURL(blob)));
      say(this.said, [...new Set(pictures.map(summed))].join(" "));
    } catch (error) {
      if (signal.aborted) return;
      this.said.textContent =
        error instanceof Refused ? error.message : "The picture did not come; it is asked again with the next change.";
    }
  }

  #replace(addresses) {
    const old = this.#addresses;
    this.#addresses = addresses;
    this.#drawn();
    this.section.removeAttribute("aria-busy");
    setTimeout(() => old.forEach((address) => URL.revokeObjectURL(address)), 1000);
  }

  #drawn() {
    if (!this.#addresses.length) return;
    const labels = this.sides.map(({ select }) => select.selectedOptions[0].textContent);
    const [left, right] = this.#addresses;
    draw(this.body, { left, right, labels }, { zoom: Number(this.zoom.select.value), look: current().look });
  }
}

/** What the server tells of a picture: its size, and which channels do not fit into the pixel. */
function summed({ summary }) {
  if (!summary.width_px) return "";
  const size = `${summary.sensor}: ${summary.width_px} \u00d7 ${summary.height_px} pixels`;
  const over = Object.entries(summary.above_full_well_share ?? {}).filter(([, share]) => share > 0);
  const told = over.map(([name, share]) => `${name} ${brief(100 * share, 2)} %`);
  return told.length ? `${size}, above full well ${told.join(", ")}.` : `${size}.`;
}

function nextSeed(study) {
  study.seed = ((study.seed ?? 0) + 1) % 2 ** 32;
}

async function picture(study, side, signal) {
  const [sensor, kind] = side.split(" ");
  const cube = cubeOf(study);
  const reply = await fetch("/api/picture", {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify({
      study,
      sensor: Number(sensor),
      noisy: kind === "noisy",
      cube: cube.startsWith("upload:") ? cube : null,
    }),
    signal,
  });
  if (reply.ok) {
    const summary = reply.headers.get("X-Chromanoise-Summary");
    return { blob: await reply.blob(), summary: summary ? JSON.parse(summary) : {} };
  }
  const told = await reply.json().catch(() => null);
  const faults = told?.faults?.length ? told.faults : [{ where: "", sentence: "The server drew no picture." }];
  throw new Refused(faults);
}
