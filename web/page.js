/**
 * Stands where the server stands: what the page asks of /api/ goes to a worker with the program.
 *
 * As one file, the page carries worker, program and prepared replies; as a folder, they lie beside it.
 */

const ASKED = "/api/";
const MODULE = "app.wasm";
const LIBRARY = "rest.zip";
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

/** Questions that take seconds; they wait until nobody asks anything else. */
const SLOW = new Set(["picture", "report", "card"]);
const REST_MS = 250;

/**
 * @typedef {object} Question
 * @property {number} id
 * @property {string} path
 * @property {Uint8Array | string} body
 * @property {string} file_name
 * @property {(reply: Response) => void} done
 */
/** Not yet in the worker, which answers one after the other. */
/** @type {Question[]} */
let queue = [];
/** @type {Question | null} */
let asked = null;
let ready = false;
let latest = -Infinity;
/** @type {number | undefined} */
let pause;

function next() {
  clearTimeout(pause);
  if (!ready || asked || !queue.length) return;
  const quick = queue.findIndex(({ path }) => !SLOW.has(path.slice(ASKED.length)));
  const rest = latest + REST_MS - performance.now();
  if (quick < 0 && rest > 0) {
    pause = setTimeout(next, rest);
    return;
  }
  [asked] = queue.splice(Math.max(quick, 0), 1);
  const { id, path, body, file_name } = asked;
  worker?.postMessage({ id, path, body, file_name });
}

/** @type {Worker | null} */
let worker = null;
/** What ends every question: why the program does not run. */
let broken = "";
let count = 0;

/**
 * The bytes of a part of this file; it is taken out of the document.
 *
 * @param {string} name
 */
function part(name) {
  const node = /** @type {HTMLElement} */ (inside(name));
  const text = node.textContent ?? "";
  node.remove();
  if ("fromBase64" in Uint8Array) return new Blob([Uint8Array.fromBase64(text)]);
  const plain = atob(text);
  const bytes = new Uint8Array(plain.length);
  for (let i = 0; i < plain.length; i += 1) bytes[i] = plain.charCodeAt(i);
  return new Blob([bytes]);
}

function workerOfPage() {
  const text = inside("worker");
  if (!text) return new Worker("worker.js");
  const address = URL.createObjectURL(new Blob([text.textContent ?? ""], { type: "text/javascript" }));
  return new Worker(address);
}

function filesOfPage() {
  if (inside(MODULE)) return { module: part(MODULE), library: part(LIBRARY) };
  const at = (/** @type {string} */ name) => new URL(`${name}.gz`, document.baseURI).href;
  return { module: at(MODULE), library: at(LIBRARY) };
}

function begin() {
  if (typeof DecompressionStream === "undefined" || !WebAssembly.validate(PROBE)) return give(OLD);
  try {
    worker = workerOfPage();
  } catch (error) {
    return give(`This place forbids the program to run (${error}); save the page as a file and open that.`);
  }
  worker.onmessage = ({ data }) => told(data);
  worker.onerror = (event) => give(`The program could not start (${event.message || "its worker was refused"}).`);
  worker.postMessage({ files: filesOfPage() });
}

/** @param {any} data */
function told(data) {
  if (data.progress) return progress(data.progress);
  if (data.ready) {
    ready = true;
    progress(null);
  } else if (data.id === undefined) return give(`The program could not start (${data.failed}).`);
  else {
    latest = performance.now();
    const question = asked;
    asked = null;
    if (question?.id === data.id) question?.done(replyOf(data));
  }
  // what the reply makes the page ask comes first
  setTimeout(next);
  return undefined;
}

/** @param {any} data */
function replyOf({ failed, status, kind, headers, content }) {
  if (failed !== undefined) return refused("The program stopped at this and started again; change it.");
  return new Response(content, { status, headers: { "Content-Type": kind, ...headers } });
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
    const place = /** @type {HTMLElement} */ (document.getElementById("broken"));
    place.textContent = sentence;
    place.hidden = false;
  };
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", show);
  else show();
  for (const question of [...queue, asked]) question?.done(refused(sentence));
  queue = [];
}

/** @param {{ file: string, come: number, size: number } | null} now */
function progress(now) {
  const place = document.getElementById("verdict");
  if (!place || place.dataset.told === "done") return;
  if (now === null) place.dataset.told = "done";
  else if (now.file.includes(MODULE)) place.textContent = `Loading the program: ${(now.come / 1e6).toFixed(0)} MB.`;
}

/** @type {Promise<Record<string, unknown>> | null} */
let prepared = null;

/** @param {string} name */
async function preparedReply(name) {
  const text = inside("prepared");
  prepared ??= text ? Promise.resolve(JSON.parse(text.textContent ?? "")) : elsewhere("prepared.json").then((reply) => reply.json());
  return Response.json((await prepared)[name]);
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
  if (["choices", "story", "explanations"].includes(name)) return preparedReply(name);
  if (broken) return refused(broken);
  let body = options.body ?? "";
  if (body instanceof Blob) body = new Uint8Array(await body.arrayBuffer());
  const file_name = decodeURIComponent(new Headers(options.headers).get("X-Filename") ?? "");
  return new Promise((done, failed) => {
    const id = (count += 1);
    queue.push({ id, path, body, file_name, done });
    if (!SLOW.has(name)) latest = performance.now();
    options.signal?.addEventListener("abort", () => {
      queue = queue.filter((question) => question.id !== id);
      failed(new DOMException("The question is not asked any more.", "AbortError"));
    });
    next();
  });
};

/** What the foot of the page says of this copy. */
function foot() {
  const place = document.querySelector("footer.foot");
  const show = async () => {
    const packed = inside("licenses.txt") ? part("licenses.txt") : await elsewhere("licenses.txt.gz").then((reply) => reply.blob());
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
  button.addEventListener("click", show);
  place?.append(
    " This page computes in your browser: your files stay on this computer. To check, disconnect the network; it goes on. " +
      "The noise of its pictures is that of the installed program. ",
    button,
  );
}

if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", foot);
else foot();
begin();
