/**
 * Runs Python files in the interpreter, for the build.
 *
 *     node freeze.mjs MODULE LIBRARY OUT [--with FILE]... [--freeze] SCRIPT...
 *
 * Files with --with are in /io for the scripts; what these write there comes to the folder OUT. With
 * --freeze, OUT gets memory.bin and globals.json of the interpreter after the last script.
 */

import fs from "node:fs";
import path from "node:path";
import { parseArgs } from "node:util";
import { Interpreter } from "./interpreter.js";

const { values, positionals } = parseArgs({
  options: { with: { type: "string", multiple: true, default: [] }, freeze: { type: "boolean", default: false } },
  allowPositionals: true,
});
const [module, library, out, ...scripts] = positionals;
const interpreter = new Interpreter(fs.readFileSync(library), { repeatable: true });
for (const file of values.with) interpreter.write(path.basename(file), fs.readFileSync(file));
await interpreter.start(await WebAssembly.compile(fs.readFileSync(module)));
for (const script of scripts) interpreter.run(fs.readFileSync(script, "utf8"));

fs.mkdirSync(out, { recursive: true });
const given = new Set(values.with.map((file) => path.basename(file)));
for (const [name, file] of interpreter.files.contents)
  if (!given.has(name)) fs.writeFileSync(path.join(out, name), file.data);
if (values.freeze) {
  const variables = Object.entries(interpreter.exports).filter(([, one]) => one instanceof WebAssembly.Global);
  const numbers = Object.fromEntries(variables.map(([name, one]) => [name, String(one.value)]));
  fs.writeFileSync(path.join(out, "memory.bin"), interpreter.memory);
  fs.writeFileSync(path.join(out, "globals.json"), JSON.stringify(numbers));
}
