/**
 * Asks the built program in Node.js, for tests.
 *
 *     node answers.mjs APP.WASM REST.ZIP QUESTIONS.json REPLIES.json
 *
 * Questions are a list of {path, body, file_name}; of each reply there are status, kind, headers, the
 * content in base64, and the time it took [ms].
 */

import fs from "node:fs";
import { Interpreter } from "./interpreter.js";

const [module, library, asked, out] = process.argv.slice(2);
const interpreter = new Interpreter(fs.readFileSync(library));
await interpreter.start(await WebAssembly.compile(fs.readFileSync(module)));
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
