/** What eslint finds beyond the types, which tsc checks. */

import js from "@eslint/js";
import globals from "globals";

export default [
  { ignores: [".venv/", "build/", "dist/", "out/"] },
  js.configs.recommended,
  {
    languageOptions: { ecmaVersion: 2023, sourceType: "module" },
    linterOptions: { reportUnusedDisableDirectives: "error" },
    rules: { eqeqeq: "error", "no-var": "error", "prefer-const": "error" },
  },
  { files: ["src/**/*.js", "web/page.js"], languageOptions: { globals: globals.browser } },
  { files: ["web/{worker,interpreter}.js"], languageOptions: { globals: globals.worker } },
  { files: ["web/*.mjs"], languageOptions: { globals: globals.node } },
];
