/** A front of a design search: its panel, and what a click loads into the study. */

import { Refused, sent, silence, understood } from "app/ask.js";
import * as cloud from "app/cloud.js";
import { attribute, byId, choice, el, fillChoice, say, square, uniqueId, within } from "app/dom.js";
import { matricesOf } from "app/matrix.js";
import { pack, tableOf, tablePlace } from "app/panels.js";
import { most } from "app/paths.js";
import { changeStudy, current, subscribe } from "app/state.js";
import { remember, shownName } from "app/uploads.js";

/** @import { Front, FrontMember, FrontScene, SensorPart, Study } from "answers" */

const TITLE = "Front of a design";
const SAME_LIGHT = "keep";

/** Members by the id that the server gave to their file. */
/** @type {Map<string, string>} */
const members = new Map();
/** @type {ReturnType<typeof frontPanel> | null} */
let panel = null;

/** Shows the front that was served with the page. */
export async function showServed() {
  try {
    const { front } = await understood(await fetch("/api/front"));
    showFront(front);
  } catch (error) {
    const notice = byId("broken");
    say(notice, sentenceOf(error));
    notice.hidden = false;
  }
}

/** @param {unknown} error */
function sentenceOf(error) {
  return error instanceof Refused ? error.message : silence("; try again.");
}

/**
 * Shows a front above the drawings, in place of an earlier one.
 *
 * @param {Front} front
 */
export function showFront(front) {
  if (panel === null) {
    panel = frontPanel();
    subscribe(({ study }) => panel?.show(study));
  }
  panel.take(front);
  return panel.section;
}

/** The panel: controls, the cloud, and its table. */
function frontPanel() {
  /** @type {Front | null} */
  let front = null;
  let [x, y] = ["", ""];
  let turn = 0;
  const across = choice({ label: "Across", options: [], on: (name) => ((x = name), redraw()) });
  const up = choice({ label: "Up", options: [], on: (name) => ((y = name), redraw()) });
  const scene = choice({ label: "Light and time", options: [], on: () => {} });
  const target = choice({ label: "A click loads the sensor", options: [], on: () => {} });
  const tools = el("div", { class: "map-tools" }, across.row, up.row, scene.row, target.row);
  const fault = el("p", { class: "fault", role: "alert", hidden: true });
  const body = el("div", { class: "body" });
  const sentences = el("ul", { class: "notes" });
  const { table, toggle } = tablePlace(TITLE, () => open(table.hidden === true));
  const away = square("\u00d7", "Close", `Close: ${TITLE}`, close);
  const heading = el("h2", { id: uniqueId("h-front"), text: TITLE });
  const section = el(
    "section",
    { class: "panel wide", "data-part": "front", "aria-labelledby": heading.id },
    el("div", { class: "head" }, heading, el("div", { class: "tools" }, toggle, away)),
    ...[tools, fault, body, sentences, table],
  );
  pack([section]);
  let width = 0;
  new ResizeObserver(([{ contentRect }]) => {
    const whole = Math.floor(contentRect.width);
    if (whole === width || whole === 0) return;
    width = whole;
    redraw();
  }).observe(body);

  /** @param {Study} study */
  const loaded = ({ sensors }) => new Set(sensors.flatMap(({ name }) => members.get(name) ?? []));

  function redraw() {
    if (!front || width === 0) return;
    cloud.draw(body, front.chart, { x, y, width, loaded: loaded(current().study), load });
  }

  /** @param {boolean} shown */
  function open(shown) {
    table.hidden = !shown;
    attribute(toggle, "aria-expanded", shown ? "true" : "false");
    table.replaceChildren(...(shown && front ? [tableOf(front.chart.table, TITLE)] : []));
  }

  function close() {
    front = null;
    section.remove();
    byId("panels").focus();
  }

  /** @param {string} name */
  async function load(name) {
    if (!front) return;
    const member = front.members[name];
    const used = front.scenes[Number(scene.select.value)];
    const mine = (turn += 1);
    try {
      const answer = await understood(await sent(member.file, new Blob([member.text])));
      // of two clicks the later one counts
      if (mine !== turn) return;
      remember("sensor", answer.id, member.file, []);
      members.set(answer.id, name);
      complain(null);
      changeStudy((study) => put(study, { name: answer.id, ...pixelOf(member) }, member, used));
    } catch (error) {
      if (mine !== turn) return;
      complain(sentenceOf(error));
    }
  }

  /** @param {string | null} sentence */
  function complain(sentence) {
    fault.hidden = sentence === null;
    say(fault, sentence ?? "");
  }

  /**
   * @param {Study} study
   * @param {SensorPart} sensor
   * @param {FrontMember} member
   * @param {FrontScene | undefined} used none where the light stays
   */
  function put(study, sensor, member, used) {
    seat(study, sensor, target.select.value);
    if (!used) return;
    study.light = used.light;
    study.exposure = { ...used.exposure, ...member.exposure };
    const matrix = member.matrix ?? used.matrix;
    if (matrix) study.matrices = [matrix, ...matricesOf(study).slice(1).filter((other) => other !== matrix)];
  }

  /** @param {Study} study */
  function show(study) {
    const places = study.sensors.map(({ name }, i) => [String(i), `in place of sensor ${i + 1}, ${shownName(name)}`]);
    const beside = study.sensors.length < most.sensors ? [["beside", "beside the others"]] : [];
    const now = [["last", "in place of the last loaded one"], ...beside, ...places];
    const kept = now.some(([value]) => value === target.select.value) ? target.select.value : "last";
    fillChoice(target.select, now, kept);
    redraw();
  }

  /** @param {Front} given */
  function take(given) {
    front = given;
    const { chart, scenes } = given;
    [x, y] = [chart.x, chart.y];
    const names = chart.axes.map(({ name, title }) => [name, title]);
    fillChoice(across.select, names, x);
    fillChoice(up.select, names, y);
    const lights = scenes.map(({ name }, i) => [String(i), `of the scene ${name}`]);
    fillChoice(scene.select, [...lights, [SAME_LIGHT, "unchanged"]], lights.length ? "0" : SAME_LIGHT);
    sentences.replaceChildren(...chart.sentences.map((text) => el("li", { text })));
    complain(null);
    if (!section.isConnected) within(byId("panels"), "[data-part=head]").after(section);
    // known before the first drawing, which then needs no second one
    width = Math.floor(body.clientWidth);
    open(table.hidden !== true);
    show(current().study);
  }

  return { section, take, show };
}

/** @param {FrontMember} member */
const pixelOf = ({ pixel }) => (Object.keys(pixel).length ? { pixel } : {});

/**
 * Puts a sensor into the study: beside the others, or in place of one of them. The first sensor
 * of a front comes beside the others where there is room.
 *
 * @param {Study} study
 * @param {SensorPart} sensor
 * @param {string} target
 */
function seat({ sensors }, sensor, target) {
  const before = sensors.findIndex(({ name }) => name === sensor.name);
  const last = sensors.findLastIndex(({ name }) => members.has(name));
  const full = sensors.length >= most.sensors ? sensors.length - 1 : -1;
  const i = target === "beside" ? full : target === "last" ? (last < 0 ? full : last) : Number(target);
  if (before >= 0 && before !== i) return;
  if (i < 0) sensors.push(sensor);
  else sensors[i] = sensor;
}
