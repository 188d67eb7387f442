/**
 * Asks the built program in Node.js, for tests.
 *
 *     node answers.mjs FOLDER QUESTIONS.json REPLIES.json
 *
 * The folder has app.wasm, memory and rest.zip. Questions are a list of {path, body, file_name}; of each
 * reply there are status, kind, headers, the content in base64, and the time it took [ms].
 */

import fs from "node:fs";
import { Interpreter } from "./interpreter.js";

const [folder, asked, out] = process.argv.slice(2);
const part = (/** @type {string} */ name) => fs.readFileSync(`${folder}/${name}`);
const interpreter = new Interpreter(part("rest.zip"));
await interpreter.start(await WebAssembly.compile(part("app.wasm")), new Blob([part("memory")]).stream());
interpreter.run("resume()");
const replies = JSON.parse(fs.readFileSync(asked, "utf8")).map(({ path, body = "", file_name = "" }) => {
  interpreter.write("head", JSON.stringify({ path, file_name }));
  interpreter.write("body", body);
  const began = performance.now();
  interpreter.run("answer()");
  const head = JSON.parse(Buffer.from(interpreter.read("head")).toString());
  const content = Buffer.from(interpreter.read("body")).toString("base64");
  return { ...head, content, ms: performance.now() - began };
});
fs.writeFileSync(out, JSON.stringify(replies));
