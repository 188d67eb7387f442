/** Small makers of elements. Data always goes in as text or attribute, never as markup. */

/** @typedef {Record<string, string | number | boolean | null | undefined>} Attributes */
/** @typedef {string | (Node | string)[]} Content */

const SVG = "http://www.w3.org/2000/svg";
let made = 0;

/**
 * An SVG element; `content` is a string or a list of nodes, and a missing attribute is left out.
 *
 * @param {string} name
 * @param {Attributes} [attributes]
 * @param {Content} [content]
 * @returns {SVGElement}
 */
export function svg(name, attributes = {}, content = []) {
  return filled(document.createElementNS(SVG, name), attributes, content);
}

/**
 * The same in HTML.
 *
 * @template {keyof HTMLElementTagNameMap} K
 * @param {K} name
 * @param {Attributes} [attributes]
 * @param {Content} [content]
 * @returns {HTMLElementTagNameMap[K]}
 */
export function html(name, attributes = {}, content = []) {
  return filled(document.createElement(name), attributes, content);
}

/**
 * @template {Element} T
 * @param {T} node
 * @param {Attributes} attributes
 * @param {Content} content
 */
function filled(node, attributes, content) {
  for (const key in attributes) {
    const value = attributes[key];
    if (value !== null && value !== undefined) node.setAttribute(key, String(value));
  }
  if (typeof content === "string") node.textContent = content;
  else if (content.length) node.append(...content);
  return node;
}

/**
 * Writes text only where it changes: after every write a browser lays out again, and a screen reader reads the text aloud.
 *
 * @param {Node} node
 * @param {string} text
 */
export function say(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/**
 * An id that nothing else on this page has.
 *
 * @param {string} prefix
 */
export function uniqueId(prefix) {
  made += 1;
  return `${prefix}-${made}`;
}

/**
 * The root of a figure: one unit is one pixel, so text keeps its size at every width.
 *
 * @param {number} width
 * @param {number} height
 * @param {string} title
 * @param {string} description
 * @param {Node[]} content
 * @param {Attributes} [attributes]
 */
export function figure(width, height, title, description, content, attributes = {}) {
  const id = uniqueId("figure");
  const told = [svg("title", { id }, title), svg("desc", { id: `${id}-desc` }, description)];
  const named = {
    class: "d-figure",
    role: "img",
    tabindex: 0, // to read its values
    width,
    height,
    viewBox: `0 0 ${width} ${height}`,
    "aria-labelledby": id,
    "aria-describedby": `${id}-desc`,
  };
  return svg("svg", { ...named, ...attributes }, [...told, ...content]);
}

/**
 * Text at a place; `look` is a list of classes of draw.css, `anchor` start, middle or end.
 *
 * @param {number} x
 * @param {number} y
 * @param {string} text
 * @param {string} [look]
 * @param {string} [anchor]
 */
export function words(x, y, text, look = "", anchor = "start") {
  const end = anchor === "start" ? null : anchor;
  return svg("text", { x: tenth(x), y: tenth(y), class: look || null, "text-anchor": end }, text);
}

/**
 * A path of straight lines through points [x, y]; `null` lifts the pen.
 *
 * @param {(number[] | null)[]} points
 */
export function line(points) {
  let told = "";
  let pen = "M";
  for (const point of points) {
    if (point === null) {
      pen = "M";
    } else {
      told += `${pen}${tenth(point[0])} ${tenth(point[1])}`;
      pen = "L";
    }
  }
  return told;
}

/**
 * Rounded to a tenth of a pixel: shorter markup, and no difference to the eye.
 *
 * @param {number} value
 */
export function tenth(value) {
  return Math.round(value * 10) / 10;
}

/**
 * Whether there is a number to draw.
 *
 * @param {unknown} value
 * @returns {value is number}
 */
export function known(value) {
  return typeof value === "number" && Number.isFinite(value);
}

/**
 * How wide a figure is: as told, or as wide as its element; read once, before anything is written.
 *
 * @param {HTMLElement} element
 * @param {{ width?: number }} options
 */
export function figureWidth(element, options) {
  const asked = options?.width ?? element.clientWidth;
  return Math.max(240, Math.round(asked || 640));
}

/**
 * The ending of a file with what an image shows.
 *
 * @param {HTMLImageElement} image
 */
export function kindOf({ src }) {
  return src.startsWith("data:image/svg") ? "svg" : "png";
}
