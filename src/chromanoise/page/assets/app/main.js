/** The page: wires the state, the questions and the panels together. */

import { Asker, understood } from "app/ask.js";
import { controls } from "app/controls.js";
import { copyButtons } from "app/copy.js";
import { say } from "app/dom.js";
import { useEquations } from "app/equations.js";
import { clearFaults, showFaults } from "app/faults.js";
import { showHead } from "app/head.js";
import { PARTS, panels, showTable } from "app/panels.js";
import { picturePanel } from "app/picture.js";
import { askedLook, snapshots } from "app/snapshots.js";
import { changeLook, current, readAddress, startFrom, subscribe } from "app/state.js";
import { themeChoice } from "app/theme.js";
import { headingTools } from "app/tools.js";
import { uploads } from "app/upload.js";

/** How long nothing moves before the parts that nobody sees are asked for. */
const IDLE_MS = 300;

const root = document.documentElement;
const byId = (id) => document.getElementById(id);

const page = {
  version: 0,
  headVersion: -1,
  failedVersion: -1,
  level: null,
  idle: null,
  head: null,
  showControls: () => {},
};

const showTheme = themeChoice(byId("theme"));

/** One sentence at the top of the page; several things may say one at a time each. */
function notice(id, sentence) {
  const node = byId(id);
  say(node, sentence ?? "");
  if (node.hidden === Boolean(sentence)) node.hidden = !sentence;
}

function question() {
  const stale = PARTS.filter((part) => page.panels.get(part).version < page.version);
  if (page.failedVersion === page.version) return null;
  const visible = stale.filter((part) => page.panels.get(part).visible);
  const fresh = page.headVersion < page.version;
  const idle = !fresh && visible.length === 0;
  // one at a time, so that what is hidden never keeps what is seen waiting
  const parts = idle ? stale.slice(0, 1) : visible;
  if (!fresh && parts.length === 0) return null;
  const { study, look } = current();
  const want = fresh ? ["head", ...parts] : parts;
  return { study, want, look: askedLook(look), version: page.version, idle };
}

function answered(reply, { version, study, want }) {
  performance.mark("answered", { detail: reply.number });
  clearFaults();
  notice("faults", null);
  page.level = study.light?.level_lux ?? null;
  for (const part of want) show(part, reply.parts[part] ?? null, version);
  say(byId("hash"), reply.hash ? `study ${reply.hash.slice(0, 12)}` : "");
  performance.mark("drawn", { detail: reply.number });
  requestAnimationFrame(() => afterPaint.postMessage(reply.number));
}

function show(part, data, version) {
  if (part === "head") {
    page.headVersion = version;
    if (!data?.sensors) return notice("faults", data?.fault ?? "The server told no verdict.");
    page.head = data;
    showHead(data);
    return page.showControls(current(), data);
  }
  const panel = page.panels.get(part);
  panel.version = version;
  if (part === "budget") page.tools.coordinates(data);
  return panel.show(data, drawingOptions(part));
}

function drawingOptions(part) {
  const { look } = current();
  const told = page.level === null ? look : { ...look, level_lux: page.level };
  return { ghosts: page.ghosts.ghosts(part), look: told, tables: page.printing };
}

function refused(faults, { version }) {
  page.failedVersion = version;
  const homeless = showFaults(faults);
  const where = homeless.length < faults.length ? "What is shown is older than the controls. " : "";
  notice("faults", (where + homeless.join(" ")).trim());
}

function rested({ idle }) {
  clearTimeout(page.idle);
  // once the rest has begun, one hidden part follows the other
  page.idle = setTimeout(() => page.asker.ask(), idle ? 0 : IDLE_MS);
}

/** A message after a frame's callback arrives when the frame was handed over to be painted. */
const channel = new MessageChannel();
const afterPaint = channel.port2;
channel.port1.onmessage = ({ data: number }) => {
  performance.mark("painted", { detail: number });
  root.dataset.painted = String(number);
  if (number % 500 === 0) performance.clearMarks();
};

function redraw(part) {
  const panel = page.panels.get(part);
  if (panel.data) panel.show(panel.data, drawingOptions(part));
}

let askedBefore = "";

function changed(state, what) {
  const asked = JSON.stringify(askedLook(state.look));
  if (what !== "look" || asked !== askedBefore) {
    page.version += 1;
    clearTimeout(page.idle);
    // first of all, so that the server computes while the controls are drawn
    page.asker.ask();
    if (asked !== askedBefore && askedBefore) page.ghosts.look();
  }
  askedBefore = asked;
  showTheme(state.look);
  page.tools.show(state.look);
  page.showControls(state, page.head);
  lookedAt(state.look);
  if (what !== "look") page.picture(state);
}

/** What changes without a question: which tables are open, how the vectors are turned. */
function lookedAt(look) {
  for (const panel of page.panels.values()) {
    const open = look.open.includes(panel.part);
    if (open === panel.table.hidden) showTable(panel, open);
  }
}

function printed() {
  page.printing = true;
  for (const part of PARTS) redraw(part);
}

function unprinted() {
  page.printing = false;
  for (const part of PARTS) redraw(part);
}

let lastKey = -Infinity;

/** Marks when a control was moved: by a key, when that went down, else when its value changed. */
function pressed({ type, timeStamp }) {
  if (type === "keydown") lastKey = timeStamp;
  else if (timeStamp - lastKey < 50) return;
  performance.mark("press", { startTime: timeStamp });
}

/** The way past the controls; the address is for the study and stays. */
function skipped(event) {
  event.preventDefault();
  byId("panels").focus();
  byId("panels").scrollIntoView();
}

function listen() {
  for (const event of ["keydown", "input"]) byId("controls").addEventListener(event, pressed, { capture: true });
  byId("panels").addEventListener("turn", ({ detail }) => changeLook((look) => (look.turn = detail.turn ?? detail)));
  document.querySelector("[data-skip]").addEventListener("click", skipped);
  window.addEventListener("hashchange", () => notice("broken", readAddress()));
  window.matchMedia("print").addEventListener("change", ({ matches }) => (matches ? printed() : unprinted()));
  window.addEventListener("beforeprint", printed);
  window.addEventListener("afterprint", unprinted);
}

async function choicesOfServer() {
  for (;;) {
    try {
      const choices = await understood(await fetch("/api/choices"));
      notice("lost", null);
      return choices;
    } catch {
      notice("lost", "The server does not answer yet; trying again.");
      await new Promise((wait) => setTimeout(wait, 500));
    }
  }
}

async function start() {
  const narrow = window.matchMedia("(max-width: 799px)");
  byId("drawer").open = !narrow.matches;
  narrow.addEventListener("change", () => (byId("drawer").open = !narrow.matches));
  const choices = await choicesOfServer();
  startFrom(choices.study);
  byId("version").textContent = `chromanoise ${choices.version}`;
  page.showControls = controls(byId("controls"), choices);
  page.tools = headingTools(choices);
  useEquations(choices.equations ?? {});
  copyButtons(byId("copy"));
  uploads(byId("bring"));
  page.ghosts = snapshots(byId("snapshots"), () => PARTS.forEach(redraw));
  page.asker = new Asker({
    question,
    answered,
    refused,
    rested,
    lost: (sentence) => notice("lost", sentence),
    found: () => notice("lost", null),
  });
  page.panels = panels({
    tools: page.tools.nodes,
    seen: () => page.asker.ask(),
    resized: (panel) => redraw(panel.part),
  });
  page.picture = picturePanel();
  listen();
  subscribe(changed);
  notice("broken", readAddress());
}

start();
