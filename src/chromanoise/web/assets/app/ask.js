/** Questions to the server: few in flight, the latest state waits, an old answer is never shown. */

/** @import { Answer, AskedLook, Fault, Study } from "answers" */
/**
 * @typedef {object} Question
 * @property {Study} study
 * @property {string[]} want
 * @property {AskedLook} look
 * @property {number} version of the study on this page
 * @property {boolean} [idle] whether it asks for what nobody sees
 * @property {number} [number]
 */
/** @typedef {{ abort: AbortController, question: Question }} Flight */
/**
 * @typedef {object} Tells
 * @property {() => Question | null} question
 * @property {(reply: Answer, question: Question) => void} answered
 * @property {(faults: Fault[], question: Question) => void} refused
 * @property {(sentence: string) => void} lost
 * @property {() => void} found
 * @property {() => void} rested
 */

/** What the server has against a question: `faults` of {where, sentence}. */
export class Refused extends Error {
  /** @param {Fault[]} faults */
  constructor(faults) {
    super(faults.map((fault) => fault.sentence).join(" "));
    this.faults = faults;
  }
}

/** Whether this page has no server: it is one file, without Matplotlib and readers of cubes. */
export const IS_FILE = document.documentElement.dataset.place === "file";
const WHO = IS_FILE ? "This page" : "The server";

/** @param {string} what follows from it */
export const silence = (what) => `${WHO} does not answer${what}`;

const LOST = silence(IS_FILE ? "; trying again." : "; is chromanoise serve still running? Trying again.");
const BUSY = "The server is busy; trying again.";

/**
 * Posts JSON and gives the parsed reply; throws Refused, or TypeError where nobody answers.
 *
 * @param {string} path
 * @param {unknown} question
 * @param {AbortSignal} [signal]
 * @returns {Promise<any>}
 */
export async function posted(path, question, signal) {
  return understood(await reply(path, question, signal));
}

/**
 * The reply to posted JSON, whatever its status; throws TypeError if the server does not answer.
 *
 * @param {string} path
 * @param {unknown} question
 * @param {AbortSignal} [signal]
 */
export function reply(path, question, signal) {
  const headers = { "Content-Type": "application/json" };
  return fetch(path, { method: "POST", headers, body: JSON.stringify(question), signal });
}

/**
 * The JSON of a reply; throws Refused with sentences where it is none.
 *
 * @param {Response} reply
 * @returns {Promise<any>}
 */
export async function understood(reply) {
  if (reply.status === 503) throw new TypeError(BUSY);
  // a fault without JSON still gets a sentence below
  const told = await reply.json().catch((error) => (reply.ok ? Promise.reject(error) : null));
  if (reply.ok && !told.faults) return told;
  const faults = Array.isArray(told?.faults) && told.faults.length ? told.faults : null;
  const sentence = `${WHO} could not compute this (status ${reply.status}); change the last setting and try again.`;
  throw new Refused(faults ?? [{ where: "", sentence }]);
}

/** Of all questions, so that no two have the same. */
let asked = 0;

/**
 * Asks `/api/answer` for what `question()` says when its turn comes, `null` for nothing.
 * `answered(reply, question)`, `refused(faults, question)`, `lost(sentence)`, `found()` and
 * `rested()`, when nothing is under way, tell what became of it. With `most` above one the
 * server computes the next state while the browser still paints the one before.
 */
export class Asker {
  #wanted = false;
  /** @type {Set<Flight>} */
  #flying = new Set();
  /** @type {number | null} */
  #retry = null;
  #pause = 250;

  /**
   * @param {Tells} tells
   * @param {number} [most]
   */
  constructor(tells, most = 1) {
    this.tells = tells;
    this.most = most;
  }

  /** A newer state is there: it is asked now, or as soon as a question in flight is back. */
  ask() {
    this.#wanted = true;
    // what nobody sees yet must not keep waiting what somebody drags
    for (const { abort, question } of this.#flying) if (question.idle) abort.abort();
    this.#next();
  }

  /**
   * Asks what is missing; of one state that is only known once its answer is back and drawn.
   *
   * @param {number | null} [undrawn]
   */
  #next(undrawn = null) {
    const lost = this.#retry !== null;
    clearTimeout(this.#retry ?? undefined);
    this.#retry = null;
    if (this.#flying.size >= this.most) return;
    const question = this.tells.question();
    const awaited = [undrawn, ...[...this.#flying].map((flight) => flight.question.version)];
    if (question && awaited.includes(question.version)) return;
    this.#wanted = false;
    if (question === null) return lost ? this.#settle() : undefined;
    question.number = asked += 1;
    const flight = { abort: new AbortController(), question };
    this.#flying.add(flight);
    this.#send(flight);
  }

  /** @param {Flight} flight */
  async #send(flight) {
    const { question } = flight;
    const outcome = await this.#outcome(question, flight.abort.signal);
    this.#flying.delete(flight);
    // the next question leaves before this answer is drawn: the server works while we draw
    if (this.#wanted && !this.#retry) this.#next(question.version);
    outcome?.();
    if (this.#wanted && !this.#retry) this.#next();
    if (!this.#flying.size && !this.#wanted) this.tells.rested();
  }

  /**
   * @param {Question} question
   * @param {AbortSignal} signal
   * @returns {Promise<(() => void) | null>}
   */
  async #outcome(question, signal) {
    const { number, study, want, look } = question;
    try {
      const reply = await posted("/api/answer", { number, study, want, look }, signal);
      this.#recover();
      return reply.number === number ? () => this.tells.answered(reply, question) : null;
    } catch (error) {
      if (error instanceof Refused) {
        this.#recover();
        return () => this.tells.refused(error.faults, question);
      }
      return signal.aborted ? null : this.#lose(error);
    }
  }

  /** @param {unknown} error */
  #lose(error) {
    this.#wanted = true;
    // of two that were lost, one asks again
    if (this.#retry === null) {
      this.#pause = Math.min(2 * this.#pause, 4000);
      this.#retry = setTimeout(() => this.#next(), this.#pause);
    }
    return () => this.tells.lost(error instanceof Error && error.message === BUSY ? BUSY : LOST);
  }

  /** Of a question that was lost nothing is missing any more: a newer one has brought it. */
  #settle() {
    if (this.#flying.size) return;
    this.#recover();
    this.tells.rested();
  }

  #recover() {
    if (this.#pause > 250) this.tells.found();
    this.#pause = 250;
  }
}

export const UNHEARD = silence(", so the file was not read; try again.");

/**
 * Uploads a file; the reply gives its kind and content.
 *
 * @param {string} name
 * @param {Blob} body
 */
export function sent(name, body) {
  const headers = { "Content-Type": "application/octet-stream", "X-Filename": encodeURIComponent(name) };
  return fetch("/api/upload", { method: "POST", headers, body });
}
