/** Control of the scene: which cube the picture shows, and what lies beyond its bands. */

import { choice, el, fillChoice } from "app/dom.js";
import { changeStudy } from "app/state.js";
import { asksFor, uploaded } from "app/uploads.js";

const STANDARD = "builtin:checker";
const BEYOND = [
  ["hold", "as at its end"],
  ["zero", "black"],
];

/** The cube of a study's picture. */
export function cubeOf(study) {
  return study.pictures?.[0]?.cube ?? STANDARD;
}

/**
 * Puts another cube into a study's first picture; the standard one needs no picture at all. `more`
 * is how it is to be read.
 */
export function setCube(study, cube, more = {}) {
  const [{ key, shape, wavelengths, scale, beyond, ...first } = {}, ...rest] = study.pictures ?? [];
  const picture = { ...first, cube, ...more }; // how the former cube was to be read says nothing of this one
  const plain = cube === STANDARD && Object.keys(picture).length === 1;
  const pictures = plain ? rest : [picture, ...rest];
  if (pictures.length) study.pictures = pictures;
  else delete study.pictures;
}

/** The group of controls: `node` and `show(state)`. */
export function sceneControls(choices) {
  const scene = choice({
    label: "Scene of the picture",
    options: [],
    where: "pictures",
    on: (cube) => changeStudy((study) => setCube(study, cube)),
  });
  const ends = choice({
    label: "Beyond the bands of its cube",
    options: BEYOND,
    where: "pictures.0.beyond",
    on: (beyond) => changeStudy((study) => (study.pictures[0].beyond = beyond)),
  });
  const show = ({ study }) => {
    const known = choices.scenes?.length ? choices.scenes : [STANDARD];
    const cube = cubeOf(study);
    const said = study.pictures?.[0]?.beyond;
    fillChoice(scene.select, [...known, ...uploaded("cube", cube)], cube);
    // what nobody said is held, and that shall not be silent
    ends.row.hidden = (said ?? "refuse") === "refuse" && !asksFor("cube", cube, "beyond");
    fillChoice(ends.select, BEYOND, BEYOND.some(([word]) => word === said) ? said : "hold");
  };
  return { node: el("div", {}, scene.row, ends.row), show };
}
