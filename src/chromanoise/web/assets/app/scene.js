/** Control of the scene: which cube the picture shows, and what lies beyond its bands. */

import { choice, el, fillChoice } from "app/dom.js";
import { defaultOf, saidAt } from "app/paths.js";
import { changeStudy } from "app/state.js";
import { asksFor, uploaded } from "app/uploads.js";

/** @import { Choices, PicturePart, State, Study } from "answers" */
/** @import { Group } from "app/controls.js" */

const BEYOND = [
  ["hold", "hold last value"],
  ["zero", "black"],
];

/** What a picture says of its cube. */
const OF_THE_CUBE = ["key", "shape", "wavelengths", "scale", "beyond"];

/**
 * The cube of a study's picture.
 *
 * @param {Study} study
 */
export function cubeOf(study) {
  return saidAt(study, "pictures.0.cube");
}

/**
 * Puts another cube into a study's first picture; the standard one needs no picture at all. `more`
 * is how it is to be read.
 *
 * @param {Study} study
 * @param {string} cube
 * @param {object} [more]
 */
export function setCube(study, cube, more = {}) {
  // how the former cube was to be read says nothing of this one
  const kept = Object.entries(study.pictures?.[0] ?? {}).filter(([key]) => !OF_THE_CUBE.includes(key));
  setPicture(study, { ...Object.fromEntries(kept), cube, ...more });
}

/**
 * Sets the denoising method of a study's first picture; `null` for none.
 *
 * @param {Study} study
 * @param {string | null} method
 */
export function setDenoising(study, method) {
  const picture = { ...study.pictures?.[0], cube: cubeOf(study) };
  if (method) picture.denoise = method;
  else delete picture.denoise;
  setPicture(study, picture);
}

/**
 * Replaces a study's first picture; a study without pictures shows the standard cube.
 *
 * @param {Study} study
 * @param {PicturePart} picture
 */
function setPicture(study, picture) {
  const rest = study.pictures?.slice(1) ?? [];
  const plain = picture.cube === defaultOf("pictures.0.cube") && Object.keys(picture).length === 1;
  if (plain && rest.length === 0) delete study.pictures;
  else study.pictures = [picture, ...rest];
}

/**
 * The group of controls: `node` and `show(state)`.
 *
 * @param {Choices} choices
 * @returns {Group}
 */
export function sceneControls(choices) {
  const scene = choice({
    label: "Scene of the picture",
    options: [],
    where: "pictures",
    on: (cube) => changeStudy((study) => setCube(study, cube)),
  });
  const ends = choice({
    label: "Outside the cube's wavelength range",
    options: BEYOND,
    where: "pictures.0.beyond",
    on: (beyond) => changeStudy(({ pictures = [] }) => (pictures[0].beyond = beyond)),
  });
  /** @param {State} state */
  const show = ({ study }) => {
    const cube = cubeOf(study);
    const said = saidAt(study, "pictures.0.beyond");
    fillChoice(scene.select, [...(choices.scenes ?? []), ...uploaded("cube", cube)], cube);
    // without a choice the ends are held; the control shows it
    ends.row.hidden = said === defaultOf("pictures.0.beyond") && !asksFor("cube", cube, "beyond");
    fillChoice(ends.select, BEYOND, BEYOND.some(([word]) => word === said) ? said : "hold");
  };
  return { node: el("div", {}, scene.row, ends.row), show };
}
