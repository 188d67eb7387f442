/** New content into an element whose old content is much the same: what stays is not touched. */

/** Each figure keeps the ids that it has, for its title and description keep them too. */
const OWN = new Set(["id", "aria-labelledby", "aria-describedby"]);

/**
 * Makes an element's children look like fresh ones that nobody listens to. A browser lays out and
 * paints only what was written, and what has the focus keeps it.
 *
 * @param {ParentNode & Node} element
 * @param {ChildNode[]} fresh
 */
export function refill(element, ...fresh) {
  const old = [...element.childNodes];
  fresh.forEach((node, i) => {
    if (!old[i]) element.append(node);
    else if (old[i].nodeName !== node.nodeName) old[i].replaceWith(node);
    else if (node.nodeType === Node.TEXT_NODE) rewrite(/** @type {Text} */ (old[i]), /** @type {Text} */ (node));
    else become(/** @type {HTMLElement} */ (old[i]), /** @type {HTMLElement} */ (node));
  });
  for (const node of old.slice(fresh.length)) node.remove();
}

/**
 * @param {HTMLElement | SVGElement} old
 * @param {HTMLElement | SVGElement} fresh
 */
function become(old, fresh) {
  if (old.isEqualNode(fresh)) return;
  for (const { name, value } of fresh.attributes) {
    if (OWN.has(name) && old.hasAttribute(name)) continue;
    if (old.getAttribute(name) === value) continue;
    // the policy of the page lets no text become a style, but a style be set
    if (name === "style") old.style.cssText = fresh.style.cssText;
    else old.setAttribute(name, value);
  }
  for (const { name } of [...old.attributes]) if (!fresh.hasAttribute(name)) old.removeAttribute(name);
  if (old.firstChild || fresh.firstChild) refill(old, ...fresh.childNodes);
}

/**
 * @param {Text} old
 * @param {Text} fresh
 */
function rewrite(old, fresh) {
  if (old.data !== fresh.data) old.data = fresh.data;
}
