/** Answers the questions of the page in a worker: the interpreter, and what brings it back after a trap. */

import { Interpreter } from "./interpreter.js";

const UNZIP = "gzip";

/** @type {{ module: WebAssembly.Module, image: Blob, library: Blob } | null} */
let parts = null;
/** @type {Interpreter | null} */
let interpreter = null;

/** @param {Record<"module" | "image" | "library", Blob | string>} files */
async function load(files) {
  const wasm = { headers: { "Content-Type": "application/wasm" } };
  const [module, image, library] = await Promise.all([
    opened(files.module).then((packed) => WebAssembly.compileStreaming(new Response(unpacked(packed), wasm))),
    opened(files.image).then((stream) => new Response(stream).blob()),
    opened(files.library).then((stream) => new Response(stream).blob()),
  ]);
  parts = { module, image, library };
  await begin();
}

/** @param {ReadableStream<Uint8Array>} stream */
const unpacked = (stream) => stream.pipeThrough(new DecompressionStream(UNZIP));

/** @param {Blob | string} file or where it is */
async function opened(file) {
  if (typeof file !== "string") return file.stream();
  const reply = await fetch(file);
  if (!reply.ok || !reply.body) throw new Error(`${file} did not come (status ${reply.status})`);
  const size = Number(reply.headers.get("Content-Length"));
  let come = 0;
  const counted = new TransformStream({
    transform(chunk, sink) {
      come += chunk.length;
      self.postMessage({ progress: { file, come, size } });
      sink.enqueue(chunk);
    },
  });
  return reply.body.pipeThrough(counted);
}

async function begin() {
  if (!parts) throw new Error("the program is not loaded");
  const next = new Interpreter(new Uint8Array(await parts.library.arrayBuffer()));
  await next.start(parts.module, unpacked(parts.image.stream()));
  next.run("resume()");
  interpreter = next;
}

/** @param {{ id: number, path: string, body: Uint8Array | string, file_name: string }} question */
async function answer({ id, path, body, file_name }) {
  if (!interpreter) await begin();
  const page = /** @type {Interpreter} */ (interpreter);
  page.write("head", JSON.stringify({ path, file_name }));
  page.write("body", body);
  try {
    page.run("answer()");
  } catch (error) {
    // its memory may be broken: the next question gets another one
    interpreter = null;
    throw error;
  }
  const head = JSON.parse(new TextDecoder().decode(page.read("head")));
  const content = page.read("body").slice();
  if (head.status === 500) console.warn(page.said);
  self.postMessage({ id, ...head, content }, { transfer: [content.buffer] });
}

/** Questions are answered one after the other. */
let turn = Promise.resolve();

self.onmessage = ({ data }) => {
  turn = turn.then(async () => {
    try {
      if (data.files) {
        await load(data.files);
        self.postMessage({ ready: true, parts });
      } else if (data.parts) {
        parts = data.parts;
        await begin();
        self.postMessage({ ready: true });
      } else await answer(data);
    } catch (error) {
      console.warn(error);
      self.postMessage({ id: data.id, failed: String(error instanceof Error ? error.message : error) });
    }
  });
};
