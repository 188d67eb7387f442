/**
 * Two pictures of the same scene, left and right of a divider. Both begin at the same place of the
 * scene, so that the same patches stand on both sides.
 */

import { html } from "draw/svg.js";

/** @import { Options } from "answers" */
/** @typedef {{ left: string, right: string, labels: string[] }} Pair */

/** @type {WeakMap<Element, ReturnType<typeof built>>} */
const shown = new WeakMap();

/**
 * `data` is {left, right: addresses of pictures, labels: [left, right]}. `options.zoom` is whole;
 * 0 for at most 1:1, where a picture is never wider than its room.
 *
 * @param {HTMLElement} element
 * @param {Pair} data
 * @param {Options<Pair>} [options]
 */
export function draw(element, data, options = {}) {
  let view = shown.get(element);
  if (!view || view.root.parentNode !== element) {
    view = built(options.look?.divider ?? 0.5);
    shown.set(element, view);
    element.replaceChildren(view.root);
  }
  const zoom = Math.max(1, Math.round(options.zoom ?? 1));
  view.root.classList.toggle("d-fit", options.zoom === 0);
  show(view.left, data.left, data.labels[0], zoom, view.root);
  show(view.right, data.right, data.labels[1], zoom, view.root);
  view.captions.forEach((caption, i) => (caption.textContent = data.labels[i]));
  view.slider.setAttribute("aria-label", `Divider between ${data.labels[0]} and ${data.labels[1]}`);
}

/**
 * The slider stays when a new picture comes, so that it keeps its place and the focus.
 *
 * @param {number} at
 */
function built(at) {
  const left = html("img", { decoding: "async" });
  const right = html("img", { decoding: "async" });
  const divider = html("span", { class: "d-divider", "aria-hidden": "true" });
  const slider = html("input", { type: "range", min: 0, max: 1000, step: 1, value: Math.round(1000 * at) });
  const stack = html("div", { class: "d-stack" }, [left, right, divider, slider]);
  const captions = [html("span"), html("span")];
  const line = html("p", { class: "d-captions" }, captions);
  const scroll = html("div", { class: "d-scroll" }, [html("div", { class: "d-reach" }, [stack])]);
  const root = html("div", { class: "d-picture" }, [line, scroll]);
  scroll.addEventListener("scroll", () => stack.style.setProperty("--from", `${scroll.scrollLeft}px`), { passive: true });
  const place = () => {
    const share = Number(slider.value) / 1000;
    stack.style.setProperty("--at", String(share));
    slider.setAttribute("aria-valuetext", `${Math.round(100 * share)} % from the left`);
  };
  slider.addEventListener("input", place);
  slider.addEventListener("keydown", (event) => leap(event, slider, place));
  place();
  return { root, left, right, slider, captions };
}

/**
 * One pixel per arrow key would take long: 1 %, and 10 % with Shift.
 *
 * @param {KeyboardEvent} event
 * @param {HTMLInputElement} slider
 * @param {() => void} place
 */
function leap(event, slider, place) {
  const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
  if (!way) return;
  event.preventDefault();
  slider.value = String(Number(slider.value) + way * (event.shiftKey ? 100 : 10));
  place();
}

/**
 * @param {HTMLImageElement} image
 * @param {string} address
 * @param {string} label
 * @param {number} zoom
 * @param {HTMLElement} root
 */
function show(image, address, label, zoom, root) {
  image.alt = label;
  const size = () => {
    image.width = image.naturalWidth * zoom;
    image.height = image.naturalHeight * zoom;
    root.style.setProperty("--wide", `${image.naturalWidth * zoom}px`);
  };
  image.onload = size;
  if (image.getAttribute("src") !== address) image.src = address;
  else if (image.complete && image.naturalWidth) size();
}
