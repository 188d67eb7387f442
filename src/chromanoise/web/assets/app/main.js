/** The page: wires the state, the questions and the panels together. */

import { Asker, silence, understood } from "app/ask.js";
import { controls } from "app/controls.js";
import { copyButtons } from "app/copy.js";
import { attribute, brief, byId, say, within } from "app/dom.js";
import { useEquations } from "app/equations.js";
import { saving } from "app/export.js";
import { clearFaults, showFaults } from "app/faults.js";
import { moreOnClick, showSensors, showVerdict, sortOnClick } from "app/head.js";
import { isTrained } from "app/matrix.js";
import { openSensors, PARTS, panels, showTable } from "app/panels.js";
import { useDefaults } from "app/paths.js";
import { picturePanel } from "app/picture.js";
import { openSensor } from "app/sensors.js";
import { narrowButtons } from "app/sheet.js";
import { askedLook, snapshots } from "app/snapshots.js";
import { changeLook, current, readAddress, startFrom, subscribe } from "app/state.js";
import { guidedStory } from "app/story.js";
import { themeChoice } from "app/theme.js";
import { headingTools } from "app/tools.js";
import { uploads } from "app/upload.js";
import { learn } from "app/uploads.js";

/** @import { Answer, Failed, Fault, Head, Look, Part, State, Study } from "answers" */
/** @import { Panel } from "app/panels.js" */
/** @import { Question } from "app/ask.js" */
/** @import { How, What } from "app/state.js" */

/** How long nothing moves before the parts that nobody sees are asked for. */
const IDLE_MS = 300;

/** Questions of the newest states that are under way at once. */
const IN_FLIGHT = 2;

/** Of A4 and Letter, where the style of print makes 0.7 of it. */
const PAPER_PX = 976;

/** A verdict takes longer than all numbers: it is asked for after a pause so long, in ms ... */
const PAUSE_MS = 60;
/** ... and at this interval while something moves: a sentence that changes faster cannot be read. */
const VERDICT_MS = 1000;

/** Parts that a trained matrix makes so slow that nothing else shall wait for them. */
const SLOW = new Set(["levels", "pareto", "chart", "vectors"]);

const root = document.documentElement;

/**
 * @typedef {object} Page
 * @property {number} version of the study
 * @property {number} headVersion of the numbers that are shown
 * @property {number} verdictVersion of the verdict that is shown
 * @property {number} judged when it was last shown or, if later, when the current motion began [ms]
 * @property {number} moved when the study last changed [ms]
 * @property {number | undefined} pause
 * @property {boolean} calm whether nothing moves
 * @property {Question | null} answered
 * @property {number} failedVersion
 * @property {number | null} level
 * @property {number | undefined} idle
 * @property {number | undefined} frame that will redraw the controls
 * @property {Study | null} pictured what the picture was last told
 * @property {Head | null} head
 * @property {boolean} printing
 * @property {(state: State, head: Head | null) => void} showControls
 * @property {ReturnType<typeof panels>} panels
 * @property {ReturnType<typeof headingTools>} tools
 * @property {((state: State) => void) | null} showMap controls of the map, loaded when it is seen
 * @property {ReturnType<typeof snapshots>} ghosts
 * @property {ReturnType<typeof picturePanel>} picture
 * @property {Asker} asker
 * @property {Asker} judge
 * @property {Asker} later
 */

/** The rest comes with the choices of the server. */
const page = /** @type {Page} */ (
  /** @type {Partial<Page>} */ ({
    version: 0,
    headVersion: -1,
    verdictVersion: -1,
    judged: -Infinity,
    moved: -Infinity,
    pause: undefined,
    calm: false,
    answered: null,
    failedVersion: -1,
    level: null,
    idle: undefined,
    frame: undefined,
    pictured: null,
    head: null,
    printing: false,
    showControls: () => {},
    showMap: null,
  })
);

/** @param {Part} part */
function panelOf(part) {
  return /** @type {Panel} */ (page.panels.get(part));
}

const showTheme = themeChoice(byId("theme"));

/**
 * One sentence at the top of the page; several things may say one at a time each.
 *
 * @param {string} id
 * @param {string | null} sentence
 */
function notice(id, sentence) {
  const node = byId(id);
  say(node, sentence ?? "");
  if (node.hidden === Boolean(sentence)) node.hidden = !sentence;
}

/** The first of two questions: the numbers, and what is seen and quick. */
function question() {
  if (page.failedVersion === page.version) return null;
  const { study, look } = current();
  const parts = stale(page.version).filter((part) => panelOf(part).visible && !isSlow(part, study));
  const want = page.headVersion < page.version ? ["numbers", ...parts] : parts;
  return want.length ? { study, want, look: askedLook(look), version: page.version } : null;
}

/** The verdict, of what the first has answered: after a pause, or often enough. */
function verdictQuestion() {
  if (!page.answered || page.failedVersion >= page.answered.version) return null;
  const { study, look, version } = page.answered;
  if (page.verdictVersion >= version) return null;
  const now = performance.now();
  if (now - page.moved >= PAUSE_MS || now - page.judged > VERDICT_MS) return { study, want: ["head"], look, version };
  clearTimeout(page.pause);
  page.pause = setTimeout(() => page.judge.ask(), PAUSE_MS);
  return null;
}

/** The second, of what the first has answered: what is seen and slow, at rest what nobody sees. */
function laterQuestion() {
  if (!page.answered || page.failedVersion >= page.answered.version) return null;
  const { study, look, version } = page.answered;
  const parts = stale(version);
  const slow = parts.filter((part) => panelOf(part).visible && isSlow(part, study));
  // the map comes last and alone, for it takes longest
  const others = slow.filter((part) => part !== "map");
  const seen = others.length ? others : slow;
  // one at a time, so that what is hidden never keeps what is seen waiting
  const idle = seen.length === 0 && page.calm;
  const want = idle ? parts.slice(0, 1) : seen;
  return want.length ? { study, want, look, version, idle } : null;
}

/** @param {number} version */
const stale = (version) => PARTS.filter((part) => panelOf(part).version < version);
/**
 * @param {Part} part
 * @param {Study} study
 */
const isSlow = (part, study) => part === "map" || (SLOW.has(part) && isTrained(study));

/**
 * @param {Answer} reply
 * @param {Question} asked
 */
function answered(reply, asked) {
  const { version, study, want } = asked;
  performance.mark("answered", { detail: reply.number });
  // a later answer to an older study mends nothing
  if (version > page.failedVersion) {
    clearFaults();
    notice("faults", null);
  }
  // of two questions under way the newer one may be back first
  if (want.includes("numbers") && version >= page.headVersion) {
    page.answered = asked;
    page.level = study.light?.level_lux ?? null;
    root.dataset.hash = reply.hash ?? "";
    say(byId("hash"), reply.hash ? `study ${reply.hash.slice(0, 12)}` : "");
  }
  for (const part of want) show(part, reply.parts[part] ?? null, version);
  if (learn(reply.files)) {
    page.pictured = null;
    showInFrame();
  }
  markStale();
  performance.mark("drawn", { detail: reply.number });
  requestAnimationFrame(() => afterPaint.postMessage(reply.number));
  page.judge.ask();
  page.later.ask();
}

/** Drawings that are older than the numbers say so until their own answer comes, if one will. */
function markStale() {
  // after a refusal nothing newer comes, and its sentence says that what is shown is older
  const awaited = page.failedVersion < page.headVersion;
  attribute(byId("verdict"), "aria-busy", awaited && page.verdictVersion < page.headVersion ? "true" : null);
  for (const { section, version, data } of page.panels.values()) {
    if (data) attribute(section, "aria-busy", awaited && version < page.headVersion ? "true" : null);
  }
}

/**
 * @param {string} part
 * @param {object | null} data
 * @param {number} version
 */
function show(part, data, version) {
  if (part === "numbers") return showNumbers(/** @type {Head | Failed | null} */ (data), version);
  if (part === "head") return judge(/** @type {Head | Failed | null} */ (data), version);
  const panel = panelOf(/** @type {Part} */ (part));
  if (version < panel.version) return undefined;
  panel.version = version;
  return panel.show(data, drawingOptions(panel.part, data));
}

/**
 * @param {Head | Failed | null} numbers without a verdict
 * @param {number} version
 */
function showNumbers(numbers, version) {
  if (version < page.headVersion) return undefined;
  page.headVersion = version;
  if (!numbers || "fault" in numbers || !numbers.sensors) {
    return notice("faults", numbers && "fault" in numbers ? numbers.fault : "No numbers available.");
  }
  page.head = { ...numbers, verdict: page.head?.verdict ?? [] };
  page.tools.channels(page.head, current().look);
  headAgain();
  return showInFrame();
}

/** Shows the controls once for all that happens before the next frame. */
function showInFrame() {
  page.frame ??= requestAnimationFrame(() => showNow(current()));
}

/** @param {State} state */
function showNow(state) {
  if (page.frame !== undefined) cancelAnimationFrame(page.frame);
  page.frame = undefined;
  showTheme(state.look);
  page.tools.show(state.look);
  page.showMap?.(state);
  page.showControls(state, page.head);
  if (state.study !== page.pictured) page.picture(state);
  page.pictured = state.study;
  lookedAt(state.look);
}

/**
 * @param {Head | Failed | null} head
 * @param {number} version
 */
function judge(head, version) {
  if (version < page.verdictVersion) return;
  page.verdictVersion = version;
  page.judged = performance.now();
  if (!head || "fault" in head) return notice("faults", head ? head.fault : "No verdict available.");
  if (page.head) showVerdict((page.head = { ...page.head, verdict: head.verdict }));
}

/**
 * @param {Part} part
 * @param {object | null} data
 */
function drawingOptions(part, data) {
  const { look } = current();
  const level = page.level === null ? {} : { level_lux: page.level, level: `${brief(page.level, 3)} lx` };
  const told = { ...look, ...level };
  return { ghosts: page.ghosts.ghosts(part, data), look: told, ...(page.printing ? { width: PAPER_PX } : {}) };
}

const OLDER = "The charts still show your last valid settings. ";
const NOTHING_YET = "Nothing can be shown until the settings marked in red are corrected. ";

/**
 * @param {Fault[]} faults
 * @param {Question} question
 */
function refused(faults, { version }) {
  // of two questions under way the newer one may be back first
  if (version < Math.max(page.headVersion, page.failedVersion)) return;
  page.failedVersion = version;
  markStale();
  const homeless = showFaults(faults);
  const beside = page.head ? OLDER : NOTHING_YET;
  const where = homeless.length < faults.length ? beside : "";
  notice("faults", (where + homeless.join(" ")).trim());
}

function rested() {
  clearTimeout(page.idle);
  page.idle = setTimeout(() => {
    page.calm = true;
    page.later.ask();
  }, IDLE_MS);
}

/** A message after a frame's callback arrives when the frame was handed over to be painted. */
const channel = new MessageChannel();
const afterPaint = channel.port2;
channel.port1.onmessage = ({ data: number }) => {
  performance.mark("painted", { detail: number });
  root.dataset.painted = String(Math.max(number, Number(root.dataset.painted ?? 0)));
  if (number % 500 === 0) performance.clearMarks();
};

/** The head as it is, after an answer or with other pins. */
function headAgain() {
  if (page.head) showSensors(page.head, page.ghosts.heads());
}

/** @param {Part} part */
function redraw(part) {
  const panel = panelOf(part);
  if (!panel.data) return;
  panel.show(panel.data, drawingOptions(part, panel.data));
  markStale();
}

let askedBefore = "";

/**
 * @param {State} state
 * @param {What} what
 * @param {How} how
 */
function changed(state, what, how) {
  const asked = JSON.stringify(askedLook(state.look));
  if (what !== "look" || asked !== askedBefore) {
    const now = performance.now();
    if (page.verdictVersion >= page.version) page.judged = now;
    page.version += 1;
    page.moved = now;
    page.calm = false;
    clearTimeout(page.idle);
    // first of all, so that the server computes while the controls are drawn
    page.asker.ask();
    if (asked !== askedBefore && askedBefore) page.ghosts.look();
  }
  askedBefore = asked;
  if (how === "slide") showInFrame();
  else showNow(state);
}

/**
 * What changes without a question: which tables are open, how the vectors are turned.
 *
 * @param {Look} look
 */
function lookedAt(look) {
  for (const panel of page.panels.values()) {
    const open = look.open.includes(panel.part);
    if (open === panel.table.hidden) showTable(panel, open);
  }
}

/** @param {boolean} printing */
function print(printing) {
  page.printing = printing;
  PARTS.forEach(redraw);
}

let lastKey = -Infinity;

/**
 * Marks when a control was moved: by a key, when that went down, else when its value changed.
 *
 * @param {Event} event
 */
function pressed({ type, timeStamp }) {
  if (type === "keydown") lastKey = timeStamp;
  else if (timeStamp - lastKey < 50) return;
  performance.mark("press", { startTime: timeStamp });
}

/**
 * The way past the controls; the address is for the study and stays.
 *
 * @param {Event} event
 */
function skipped(event) {
  event.preventDefault();
  byId("panels").focus();
  byId("panels").scrollIntoView();
}

function listen() {
  for (const event of ["keydown", "input"]) byId("controls").addEventListener(event, pressed, { capture: true });
  byId("panels").addEventListener("turn", (event) => {
    const { detail } = /** @type {CustomEvent} */ (event);
    changeLook((look) => (look.turn = detail.turn ?? detail));
  });
  within(document, "[data-skip]").addEventListener("click", skipped);
  window.addEventListener("hashchange", () => notice("broken", readAddress()));
  window.matchMedia("print").addEventListener("change", ({ matches }) => print(matches));
  window.addEventListener("beforeprint", () => print(true));
  window.addEventListener("afterprint", () => print(false));
}

/** For so long a server may think before its silence is told. */
const PATIENCE_MS = 10_000;

async function choicesOfServer() {
  for (;;) {
    try {
      const choices = await understood(await fetch("/api/choices", { signal: AbortSignal.timeout(PATIENCE_MS) }));
      notice("lost", null);
      return choices;
    } catch {
      notice("lost", silence(" yet; trying again."));
      await new Promise((wait) => setTimeout(wait, 500));
    }
  }
}

/** @param {import("answers").Choices} choices */
async function withMapControls(choices) {
  page.showMap = () => {};
  const { mapControls } = await import("app/map.js");
  const { node, show } = mapControls(choices);
  panelOf("map").fault.before(node);
  page.showMap = show;
  show(current());
}

async function start() {
  narrowButtons();
  const choices = await choicesOfServer();
  useDefaults(choices);
  startFrom(choices.study);
  byId("version").textContent = `chromanoise ${choices.version}`;
  page.showControls = controls(byId("controls"), choices);
  page.tools = headingTools(choices);
  useEquations();
  copyButtons(byId("copy"));
  uploads(byId("bring"));
  page.ghosts = snapshots(byId("snapshots"), () => {
    headAgain();
    PARTS.forEach(redraw);
  });
  const told = {
    answered,
    refused,
    lost: /** @param {string} sentence */ (sentence) => notice("lost", sentence),
    found: () => notice("lost", null),
  };
  page.asker = new Asker({ ...told, question, rested }, IN_FLIGHT);
  page.judge = new Asker({ ...told, question: verdictQuestion, rested: () => page.judge.ask() });
  page.later = new Asker({ ...told, question: laterQuestion, rested: () => page.later.ask() });
  page.panels = panels(choices.sections, {
    tools: page.tools.nodes,
    seen: () => {
      if (panelOf("map").visible && !page.showMap) withMapControls(choices);
      page.asker.ask();
      page.later.ask();
    },
    resized: (panel) => redraw(panel.part),
  });
  const names = choices.sensors.map((/** @type {import("answers").KnownSensor} */ one) => one.name);
  openSensors(names, openSensor);
  sortOnClick(() => page.head, headAgain);
  moreOnClick();
  page.picture = picturePanel(choices);
  listen();
  subscribe(changed);
  guidedStory(byId("story"), byId("tour"));
  root.dataset.version = choices.version;
  saving(page.panels.values(), choices);
  notice("broken", readAddress());
  if (choices.front) import("app/front.js").then(({ showServed }) => showServed());
}

start();
