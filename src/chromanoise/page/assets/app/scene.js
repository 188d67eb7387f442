/** Control of the scene: which cube the picture shows, and which draw of the noise. */

import { choice, el, fillChoice } from "app/dom.js";
import { changeStudy } from "app/state.js";
import { uploaded } from "app/uploads.js";

const STANDARD = "builtin:checker";

/** The cube of a study's picture. */
export function cubeOf(study) {
  return study.pictures?.[0]?.cube ?? STANDARD;
}

/** Puts another cube into a study's first picture; the standard one needs no picture at all. */
export function setCube(study, cube) {
  const [{ key, shape, wavelengths, scale, ...first } = {}, ...rest] = study.pictures ?? [];
  const picture = { ...first, cube }; // how the former cube was to be read says nothing of this one
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
  const show = ({ study }) => {
    const known = choices.scenes?.length ? choices.scenes : [STANDARD];
    fillChoice(scene.select, [...known, ...uploaded("cube")], cubeOf(study));
  };
  return { node: el("div", {}, scene.row), show };
}
