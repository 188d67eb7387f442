/**
 * Stands where the server stands: what the page asks of /api/ goes to a worker with the program.
 *
 * As one file, the page carries worker, program and prepared replies; as a folder, they lie beside it.
 */

const ASKED = "/api/";
const UPLOAD = "/api/upload";
const MODULE = "app.wasm";
const IMAGE = "memory";
const LIBRARY = "rest.zip";
const FORBIDS =
  "The place that this page comes from forbids it to run WebAssembly. Save chromanoise.html as a file, and open that.";
const OLD =
  "This browser cannot run the program: it needs WebAssembly with exceptions (Chrome or Edge 137, Firefox 131, " +
  "Safari 18.4 or newer). Update it, or install chromanoise.";

/** @param {string} name */
const inside = (name) => document.getElementById(`inside-${name}`);

/** A module with exceptions whose kind can be thrown again: (type)(func)(tag)(try_table (catch_all_ref)). */
const PROBE = new Uint8Array([
  ...[0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0, 3, 2, 1, 0],
  ...[10, 15, 1, 13, 0, 2, 0x69, 0x1f, 0x40, 1, 3, 0, 0x0b, 0x00, 0x0b, 0x1a, 0x0b],
]);

/** Questions that take seconds have an interpreter of their own, which ends when it rests. */
const SLOW = new Set(["picture", "report", "card"]);
const REST_MS = 2000;

/**
 * @typedef {object} Question
 * @property {number} id
 * @property {string} path
 * @property {Uint8Array | string} body
 * @property {string} file_name
 * @property {(reply: Response) => void} done
 */

/** What was dropped: each new interpreter gets it first. */
/** @type {Pick<Question, "path" | "body" | "file_name">[]} */
const dropped = [];

/** One interpreter, which answers one question after the other. */
class Lane {
  /** @type {Question[]} */
  #queue = [];
  /** @type {Question | null} */
  #asked = null;
  #ready = false;
  #given = 0;

  /**
   * @param {object} start what the worker begins with
   * @param {{ started?: (parts: object) => void, rested?: () => void, progress?: (now: any) => void }} tells
   */
  constructor(start, tells) {
    this.tells = tells;
    this.worker = workerOfPage();
    this.worker.onmessage = ({ data }) => this.#told(data);
    this.worker.onerror = (event) => give(`The program could not start (${event.message || "its worker was refused"}).`);
    this.worker.postMessage(start);
  }

  get rests() {
    return !this.#asked && !this.#queue.length;
  }

  /** @param {Question} question */
  ask(question) {
    this.#queue.push(question);
    this.#next();
  }

  /** @param {number} id of a question that nobody waits for any more */
  forget(id) {
    this.#queue = this.#queue.filter((question) => question.id !== id);
  }

  /** @param {string} sentence the reply to all */
  end(sentence) {
    for (const question of [this.#asked, ...this.#queue]) question?.done(refused(sentence));
    this.#queue = [];
  }

  #next() {
    if (!this.#ready || this.#asked || !this.#queue.length) return;
    if (this.#given < dropped.length) {
      this.#asked = { id: -1, ...dropped[this.#given], done: () => {} };
      this.#given += 1;
    } else this.#asked = this.#queue.shift() ?? null;
    if (!this.#asked) return;
    const { id, path, body, file_name } = this.#asked;
    this.worker.postMessage({ id, path, body, file_name });
  }

  /** @param {any} data */
  #told(data) {
    if (data.progress) this.tells.progress?.(data.progress);
    else if (data.ready) {
      this.#ready = true;
      this.tells.started?.(data.parts);
    } else if (data.id === undefined) give(whyNot(data.failed));
    else this.#answered(data);
    this.#next();
    if (this.#ready && this.rests) this.tells.rested?.();
  }

  /** @param {any} data */
  #answered({ failed, status, kind, headers, content }) {
    const question = this.#asked;
    this.#asked = null;
    if (!question) return;
    if (failed !== undefined) {
      this.#given = 0; // its next interpreter has nothing yet
      question.done(refused("The program stopped at this and started again; change it."));
      return;
    }
    if (question.path === UPLOAD && question.id >= 0) {
      const { path, body, file_name } = question;
      dropped.push({ path, body, file_name });
      if (this.#given === dropped.length - 1) this.#given += 1;
    }
    question.done(new Response(content, { status, headers: { "Content-Type": kind, ...headers } }));
  }
}

/** What ends every question: why the program does not run. */
let broken = "";
let count = 0;
/** @type {Lane | null} */
let quick = null;
/** @type {Lane | null} */
let slow = null;
/** @type {number | undefined} */
let end;
/** @type {(parts: object) => void} */
let tellParts = () => {};
/** @type {Promise<object>} */
const parts = new Promise((done) => (tellParts = done));

/** @param {object} started */
function slowLane(started) {
  clearTimeout(end);
  const rested = () => {
    clearTimeout(end);
    end = setTimeout(() => {
      if (!slow?.rests) return;
      slow.worker.terminate();
      slow = null;
    }, REST_MS);
  };
  slow ??= new Lane({ parts: started }, { rested });
  return slow;
}

/** @param {string} failed */
function whyNot(failed) {
  if (/unsafe-eval|Content.Security|policy/i.test(failed)) return FORBIDS;
  return `The program could not start (${failed}).`;
}

/**
 * The bytes of a part of this file; it is taken out of the document.
 *
 * @param {string} name
 */
function part(name) {
  const node = /** @type {HTMLElement} */ (inside(name));
  const blobs = [];
  let rest = "";
  for (const one of /** @type {NodeListOf<Text>} */ (node.childNodes)) {
    const text = rest + one.data;
    one.data = ""; // frees it now
    const whole = text.length - (text.length % 4);
    rest = text.slice(whole);
    blobs.push(new Blob([decoded(text.slice(0, whole))]));
  }
  node.remove();
  return new Blob(blobs);
}

/** @param {string} text in base64 */
function decoded(text) {
  if ("fromBase64" in Uint8Array) return Uint8Array.fromBase64(text);
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

function workerOfPage() {
  const text = inside("worker");
  if (!text) return new Worker("worker.js");
  const address = URL.createObjectURL(new Blob([text.textContent ?? ""], { type: "text/javascript" }));
  return new Worker(address);
}

function filesOfPage() {
  const at = (/** @type {string} */ name) => new URL(`${name}.bin`, document.baseURI).href;
  const file = inside(MODULE) ? part : at;
  return { module: file(MODULE), image: file(IMAGE), library: file(LIBRARY) };
}

function begin() {
  if (typeof DecompressionStream === "undefined" || !WebAssembly.validate(PROBE)) return give(OLD);
  try {
    quick = new Lane({ files: filesOfPage() }, { started: (given) => given && tellParts(given), progress });
  } catch {
    return give(FORBIDS);
  }
  return undefined;
}

/** @param {string} sentence */
function refused(sentence) {
  return new Response(JSON.stringify({ faults: [{ where: "", sentence }] }), {
    headers: { "Content-Type": "application/json" },
  });
}

/** @param {string} sentence why nothing will be answered */
function give(sentence) {
  broken = sentence;
  const show = () => {
    if (loading) /** @type {HTMLElement} */ (document.getElementById("verdict")).textContent = "";
    if (document.getElementById("unable")) return;
    const told = document.createElement("p");
    told.id = "unable";
    told.className = "notice";
    told.setAttribute("role", "alert");
    told.textContent = sentence;
    document.getElementById("broken")?.before(told);
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", show);
  else show();
  tellParts({}); // whoever waits for them gets the sentence
  quick?.end(sentence);
  slow?.end(sentence);
}

let loading = false;

/** @param {{ file: string, come: number, size: number }} now */
function progress({ file, come, size }) {
  const place = document.getElementById("verdict");
  if (!place || !file.includes(MODULE)) return;
  loading = true;
  const whole = size ? ` of ${(size / 1e6).toFixed(0)}` : "";
  place.textContent = `Loading the program: ${(come / 1e6).toFixed(0)}${whole} MB.`;
}

/** @type {Promise<Record<string, unknown>> | null} */
let prepared = null;

/** @param {string} name */
async function preparedReply(name) {
  const text = inside("prepared");
  prepared ??= text ? Promise.resolve(JSON.parse(text.textContent ?? "")) : fetched("prepared.json");
  const all = await prepared.catch((error) => {
    prepared = null;
    throw error;
  });
  return name in all ? Response.json(all[name]) : new Response("{}", { status: 404 });
}

/** @param {string} name */
async function fetched(name) {
  const reply = await elsewhere(name);
  if (!reply.ok) throw new TypeError(`${name} did not come (status ${reply.status})`);
  return reply.json();
}

const elsewhere = globalThis.fetch.bind(globalThis);

/**
 * @param {RequestInfo | URL} address
 * @param {RequestInit} [options]
 */
globalThis.fetch = async (address, options = {}) => {
  const path = String(address);
  if (!path.startsWith(ASKED)) return elsewhere(address, options);
  const name = path.slice(ASKED.length);
  if (!options.method) return preparedReply(name);
  let body = options.body ?? "";
  if (body instanceof Blob) body = new Uint8Array(await body.arrayBuffer());
  const file_name = decodeURIComponent(new Headers(options.headers).get("X-Filename") ?? "");
  const started = SLOW.has(name) ? await parts : null;
  if (broken || !quick) return refused(broken);
  const lane = started ? slowLane(started) : quick;
  return new Promise((done, failed) => {
    const id = (count += 1);
    const forget = () => {
      lane.forget(id);
      failed(new DOMException("The question is not asked any more.", "AbortError"));
    };
    if (options.signal?.aborted) return forget();
    options.signal?.addEventListener("abort", forget);
    return lane.ask({ id, path, body, file_name, done });
  });
};

/** What the foot of the page says of this copy. */
function foot() {
  const place = document.querySelector("footer.foot");
  const show = async () => {
    const packed = inside("licenses.txt") ? part("licenses.txt") : await elsewhere("licenses.txt.bin").then((reply) => reply.blob());
    const text = await new Response(packed.stream().pipeThrough(new DecompressionStream("gzip"))).text();
    const shown = document.createElement("pre");
    shown.className = "licenses";
    shown.textContent = text;
    button.replaceWith(shown);
  };
  const button = document.createElement("button");
  button.type = "button";
  button.className = "link";
  button.textContent = "Licenses of everything inside";
  button.addEventListener("click", show, { once: true });
  place?.append(
    " This page computes in your browser, so your files stay on this computer: it works without a network, too. " +
      "Its pictures have the same noise as those of the installed program. ",
    button,
  );
}

document.getElementById("inert")?.remove();
document.documentElement.dataset.place = "file";
if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", foot);
else foot();
begin();
