/** Charts and pictures as files: SVG that stands alone, PNG of it, CSV; loaded when first used. */

import { html, kindOf, svg, tenth } from "draw/svg.js";

/** @import { Saved } from "draw/save.js" */

const WIDTH_PX = 960;
/** Of the PNG: 300 dpi where a pixel of the drawing is 1/96 in. */
const SCALE = 300 / 96;
const MOST_PIXELS = 120e6;
/** The chunk pHYs with 11811 pixels per m, and its check sum. */
const DENSITY = [0, 0, 0, 9, 112, 72, 89, 115, 0, 0, 46, 35, 0, 0, 46, 35, 1, 120, 165, 63, 118];
const HEAD_BYTES = 33; // of a PNG: signature and IHDR

/** Properties that a drawing sets, with what holds where none is set. */
/** @type {Record<string, string>} */
const LOOK = {
  fill: "rgb(0, 0, 0)",
  "fill-opacity": "1",
  stroke: "none",
  "stroke-width": "1px",
  "stroke-opacity": "1",
  "stroke-dasharray": "none",
  "stroke-linejoin": "miter",
  "font-size": "13px",
  "font-weight": "400",
};

/** Characters that XML does not allow, and a name in a file of curves may have. */
const NOT_XML = /[^\P{Cc}\t\n\r]|[\ufffe\uffff]/gu;

/** What a file alone has no use for. */
const UNUSED = /^(class|style|id|role|tabindex|aria-.*|visibility)$/;

/** @param {Saved} saved */
export async function saveSvg(saved) {
  download(new Blob([svgText(saved)], { type: "image/svg+xml" }), saved.part, "svg");
}

/** @param {Saved} saved */
export async function savePng(saved) {
  download(await pngOf(svgText(saved)), saved.part, "png");
}

/** @param {Saved} saved */
export async function saveCsv(saved) {
  download(new Blob([await saved.csv()], { type: "text/csv" }), saved.part, "csv");
}

/** @param {HTMLImageElement} image */
export function savePicture(image) {
  fetched(image.src, image.closest(".d-stack") ? `picture-${image.alt}` : image.alt, kindOf(image));
}

/**
 * Both pictures with the divider where it stands.
 *
 * @param {HTMLElement} element
 */
export async function saveDivided(element) {
  const [left, right] = /** @type {NodeListOf<HTMLImageElement>} */ (element.querySelectorAll(".d-stack img"));
  const [stack, divider] = [".d-stack", ".d-divider"].map((one) => /** @type {HTMLElement} */ (element.querySelector(one)));
  const { naturalWidth, naturalHeight: height } = left;
  // pixels of the picture
  const [width, at, from] = [stack.offsetWidth, divider.offsetLeft + divider.offsetWidth / 2, -left.offsetLeft].map((length) =>
    Math.round((length * naturalWidth) / left.offsetWidth),
  );
  const { canvas, pen } = sheet(width, height);
  pen.drawImage(left, -from, 0);
  pen.drawImage(right, from, 0, naturalWidth - from, height, at, 0, naturalWidth - from, height);
  pen.fillStyle = "#ffffff";
  pen.fillRect(at - 1, 0, 2, height);
  download(await blobOf(canvas), "picture-divided", "png");
}

/**
 * The name of a file, with the study that it is of.
 *
 * @param {string} part
 * @param {string} ending
 * @param {string} [study] its hash; that of what is shown where it is missing
 */
function fileName(part, ending, study = document.documentElement.dataset.hash) {
  const words = part.toLowerCase().replace(/[^a-z0-9]+/g, "-").replace(/^-/, "").slice(0, 60).replace(/-$/, "");
  const hash = study?.slice(0, 8);
  return `${["chromanoise", words, hash].filter(Boolean).join("-")}.${ending}`;
}

/**
 * @param {Blob} blob
 * @param {string} part
 * @param {string} ending
 * @param {string} [study]
 */
export function download(blob, part, ending, study) {
  const address = URL.createObjectURL(blob);
  fetched(address, part, ending, study);
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}

/**
 * @param {string} address
 * @param {string} part
 * @param {string} ending
 * @param {string} [study]
 */
function fetched(address, part, ending, study) {
  const link = html("a", { href: address, download: fileName(part, ending, study) });
  document.body.append(link);
  link.click();
  link.remove();
}

/**
 * The chart as SVG: drawn anew on white, as wide on every screen, with all words around it.
 *
 * @param {Saved} saved
 */
export function svgText(saved) {
  const inner = html("div");
  const holder = html("div", { class: "d-offscreen" }, [inner]);
  document.body.append(holder);
  try {
    saved.draw(inner);
    return new XMLSerializer().serializeToString(composed(holder, saved)).replace(NOT_XML, "\ufffd");
  } finally {
    holder.remove();
  }
}

/**
 * @param {HTMLElement} holder
 * @param {Saved} saved
 */
function composed(holder, { heading, data, note = () => "" }) {
  const box = holder.getBoundingClientRect();
  const figures = [...holder.querySelectorAll("svg")].filter((one) => !one.ownerSVGElement);
  const nodes = figures.map((figure) => {
    const at = figure.getBoundingClientRect();
    const scale = at.width / (figure.viewBox.baseVal.width || at.width);
    const place = `translate(${tenth(at.left - box.left)} ${tenth(at.top - box.top)})`;
    const transform = Math.abs(scale - 1) < 1e-3 ? place : `${place} scale(${scale})`;
    return svg("g", { transform }, [...figure.children].flatMap((child) => inlined(child, null)));
  });
  const { version, hash } = document.documentElement.dataset;
  const { title, description = "" } = data();
  const height = Math.ceil(box.height);
  return svg(
    "svg",
    {
      ...{ width: WIDTH_PX, height, viewBox: `0 0 ${WIDTH_PX} ${height}` },
      ...{ "font-family": "sans-serif", "font-size": 13 },
    },
    [
      svg("title", {}, `${heading}: ${title}`),
      svg("desc", {}, [`${title}.`, description, note()].filter(Boolean).join(" ")),
      svg("metadata", {}, `chromanoise ${version}, study ${hash}`),
      svg("rect", { width: WIDTH_PX, height, fill: "#ffffff" }),
      ...nodes,
      ...words(holder, box),
    ],
  );
}

/**
 * A copy without classes: what they say stands in its attributes. Letters with a rim become two
 * texts, for not every program paints the rim first.
 *
 * @param {Element} node
 * @param {CSSStyleDeclaration | null} around
 * @returns {Element[]}
 */
function inlined(node, around) {
  const look = getComputedStyle(node);
  if (look.visibility === "hidden") return [];
  const copy = svg(node.localName);
  for (const { name, value } of node.attributes) {
    if (name in LOOK || UNUSED.test(name)) continue;
    copy.setAttribute(name, value);
  }
  if (node.localName === "title" || node.localName === "desc") {
    copy.textContent = node.textContent;
    return [copy];
  }
  for (const [name, initial] of Object.entries(LOOK)) {
    const value = look.getPropertyValue(name);
    if (value !== (around ? around.getPropertyValue(name) : initial)) copy.setAttribute(name, value.replace(/px/g, ""));
  }
  for (const child of node.childNodes) {
    if (child instanceof Element) copy.append(...inlined(child, look));
    else copy.append(child.cloneNode());
  }
  if (node.localName !== "text" || look.stroke === "none" || look.paintOrder === "normal") return [copy];
  const rim = /** @type {Element} */ (copy.cloneNode(true));
  rim.setAttribute("fill", look.stroke);
  copy.setAttribute("stroke", "none");
  return [rim, copy];
}

/**
 * Every line of words in HTML around the figures, where it stands.
 *
 * @param {HTMLElement} holder
 * @param {DOMRect} box
 */
function words(holder, box) {
  /** @type {Node[]} */
  const nodes = [];
  const pen = /** @type {CanvasRenderingContext2D} */ (document.createElement("canvas").getContext("2d"));
  const walker = document.createTreeWalker(holder, NodeFilter.SHOW_TEXT);
  while (walker.nextNode()) {
    const node = /** @type {Text} */ (walker.currentNode);
    const parent = /** @type {HTMLElement} */ (node.parentElement);
    if (parent.closest("svg, button, [role=status], [hidden]")) continue;
    const look = getComputedStyle(parent);
    pen.font = `${look.fontWeight} ${look.fontSize} ${look.fontFamily}`;
    const ascent = pen.measureText("x").fontBoundingBoxAscent;
    const attributes = { fill: look.color, "font-size": parseFloat(look.fontSize), "font-weight": look.fontWeight };
    const item = parent.closest("ol > li");
    lines(node).forEach(({ text, rect }, i) => {
      const [x, y] = [tenth(rect.left - box.left), tenth(rect.top - box.top + ascent)];
      nodes.push(svg("text", { x, y, ...attributes }, text));
      if (item && i === 0) {
        const number = `${[...(item.parentElement?.children ?? [])].indexOf(item) + 1}.`;
        nodes.push(svg("text", { x: x - 6, y, "text-anchor": "end", ...attributes }, number));
      }
    });
  }
  return nodes;
}

/**
 * The lines into which a text is broken.
 *
 * @param {Text} node
 */
function lines(node) {
  /** @type {{ text: string, rect: DOMRect }[]} */
  const found = [];
  const range = document.createRange();
  for (const word of node.data.matchAll(/\S+\s*/g)) {
    range.setStart(node, word.index);
    range.setEnd(node, word.index + word[0].trimEnd().length);
    const rect = range.getBoundingClientRect();
    const last = found[found.length - 1];
    if (last && Math.abs(last.rect.top - rect.top) < 2) last.text += word[0];
    else if (rect.width) found.push({ text: word[0], rect });
  }
  return found;
}

/**
 * @param {string} text of an SVG
 */
async function pngOf(text) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
  await image.decode();
  const [width, height] = [image.width, image.height].map((side) => Math.round(side * SCALE));
  if (width * height > MOST_PIXELS) throw new Error("The chart is too tall for a PNG; save it as SVG.");
  const { canvas, pen } = sheet(width, height);
  pen.drawImage(image, 0, 0, width, height);
  const png = await blobOf(canvas);
  return new Blob([png.slice(0, HEAD_BYTES), new Uint8Array(DENSITY), png.slice(HEAD_BYTES)], { type: png.type });
}

/**
 * @param {number} width
 * @param {number} height
 */
function sheet(width, height) {
  const canvas = html("canvas", { width, height });
  return { canvas, pen: /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d")) };
}

/**
 * @param {HTMLCanvasElement} canvas
 * @returns {Promise<Blob>}
 */
function blobOf(canvas) {
  return new Promise((done, failed) => {
    canvas.toBlob((blob) => (blob ? done(blob) : failed(new Error("This browser cannot make a PNG of this size."))), "image/png");
  });
}
