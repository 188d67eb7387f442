/** CPython in WebAssembly: it runs code, turn by turn, and files in memory carry what goes in and out. */

import { ConsoleStdout, Directory, File, OpenFile, PreopenDirectory, WASI } from "@bjorn3/browser_wasi_shim";

/** The only name under which the interpreter looks for its library. */
const LIBRARY = "python315.zip";
/** The custom section of a frozen module, and the size of its pages: as of wasm.py. */
const PAGES = "pages";
const PAGE_BYTES = 4096;
const MOST_LEFT_BYTES = 8 << 20;
const ENVIRONMENT = ["HOME=/tmp", "TMPDIR=/tmp", "PYTHONTZPATH=", "PYTHONDONTWRITEBYTECODE=1", "PYTHONHASHSEED=0"];

export class Interpreter {
  #said = [];

  /**
   * @param {Uint8Array} library the zip with all modules of Python
   * @param {{ repeatable?: boolean }} [options] without a clock and without chance, for builds
   */
  constructor(library, { repeatable = false } = {}) {
    const folder = (/** @type {[string, unknown][]} */ ...entries) => new Directory(new Map(entries));
    const line = ConsoleStdout.lineBuffered((text) => this.#said.push(text));
    this.files = folder();
    const usr = folder(["local", folder(["lib", folder([LIBRARY, new File(library, { readonly: true })])])]);
    const root = new Map([["usr", usr], ["tmp", folder()], ["io", this.files]]);
    const open = [new OpenFile(new File(new Uint8Array())), line, line, new PreopenDirectory("/", root)];
    this.wasi = new WASI(["/usr/local/bin/python.wasm"], ENVIRONMENT, open, { debug: false });
    this.calls = { ...this.wasi.wasiImport, sched_yield: () => 0 };
    if (repeatable) Object.assign(this.calls, withoutChance(this));
  }

  /**
   * Makes the interpreter; a module that was frozen goes on where it was, with the image of its memory.
   *
   * @param {WebAssembly.Module} module
   * @param {ReadableStream<Uint8Array>} [image]
   */
  async start(module, image) {
    const imports = { wasi_snapshot_preview1: this.calls, host: { call: () => -1 } };
    const instance = await WebAssembly.instantiate(module, imports);
    this.exports = instance.exports;
    this.wasi.inst = instance;
    if (image) await this.#fill(WebAssembly.Module.customSections(module, PAGES)[0], image);
    this.exports._initialize?.();
  }

  /**
   * Puts each page of an image where it belongs, piece by piece.
   *
   * @param {ArrayBuffer} numbers of these pages
   * @param {ReadableStream<Uint8Array>} image
   */
  async #fill(numbers, image) {
    const pages = new Uint32Array(numbers);
    const { memory } = this;
    const reader = image.getReader();
    let at = 0;
    let left = 0;
    for (let piece = await reader.read(); !piece.done; piece = await reader.read()) {
      let rest = piece.value;
      while (rest.length) {
        const inside = at % PAGE_BYTES;
        const part = rest.subarray(0, PAGE_BYTES - inside);
        memory.set(part, pages[(at - inside) / PAGE_BYTES] * PAGE_BYTES + inside);
        at += part.length;
        rest = rest.subarray(part.length);
      }
      left += piece.value.length;
      if (left > MOST_LEFT_BYTES) left = freed();
    }
    freed();
  }

  /** What the last turn printed. */
  get said() {
    return this.#said.join("\n");
  }

  get memory() {
    return new Uint8Array(this.exports.memory.buffer);
  }

  /**
   * Runs code of Python; throws what it printed where it fails.
   *
   * @param {string} code
   */
  run(code) {
    this.#said.length = 0;
    const data = new TextEncoder().encode(code);
    const place = this.exports.host_alloc(data.length) >>> 0;
    this.memory.set(data, place);
    const failed = this.exports.turn(place, data.length);
    // the shim numbers each opened file anew
    while (this.wasi.fds.at(-1) === undefined) this.wasi.fds.pop();
    if (failed) throw new Error(this.said || `the interpreter ended with ${failed}`);
  }

  /**
   * @param {string} name
   * @param {Uint8Array | string} content
   */
  write(name, content) {
    const data = typeof content === "string" ? new TextEncoder().encode(content) : content;
    this.files.contents.set(name, new File(data));
  }

  /** @param {string} name */
  read(name) {
    return this.files.contents.get(name).data;
  }
}

/** Makes a browser free the pieces of streams: it looks for garbage when a script allocates. */
function freed() {
  for (let i = 0; i < 64; i += 1) new ArrayBuffer(1 << 20);
  return 0;
}

/** @param {Interpreter} interpreter */
function withoutChance(interpreter) {
  let now = 1_767_225_600_000_000_000n; // 2026-01-01
  return {
    clock_time_get(_clock, _precision, place) {
      now += 1_000_000n;
      new DataView(interpreter.exports.memory.buffer).setBigUint64(place, now, true);
      return 0;
    },
    random_get(place, count) {
      interpreter.memory.fill(0x5a, place, place + count);
      return 0;
    },
  };
}
