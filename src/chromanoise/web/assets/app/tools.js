/** Small controls in the headings of panels: what is looked at, not what is computed from. */

import { choice, fillChoice } from "app/dom.js";
import { changeLook } from "app/state.js";

/** @import { Choices, Head, Look } from "answers" */
/** @import { Option } from "app/dom.js" */

const MAGNIFICATIONS = ["auto", "1", "2", "5", "10", "20", "50", "100"];

/**
 * The tools by part: nodes, and `show(look)` that sets them to a look.
 *
 * @param {Choices} choices
 */
export function headingTools(choices) {
  const coordinates = choices.coordinates ?? ["X", "Y", "Z"];
  const coordinate = tool("Coordinate", coordinates, (name) => changeLook((look) => (look.coordinate = name)));
  const planes = [["ab", "a*b*"], ["xy", "x y"]];
  const plane = tool("Plane", planes, (name) => changeLook((look) => (look.plane = name)));
  const times = MAGNIFICATIONS.map((text) => [text, text === "auto" ? "size: auto" : `\u00d7${text}`]);
  const magnification = tool("Magnification of the ellipsoid", times, (text) =>
    changeLook((look) => (look.magnification = text === "auto" ? null : Number(text))),
  );
  let offered = coordinates;
  /** @param {Look} look */
  const show = (look) => {
    fillChoice(coordinate.select, offered, look.coordinate);
    fillChoice(plane.select, planes, look.plane);
    fillChoice(magnification.select, times, String(look.magnification ?? "auto"));
  };
  /**
   * A budget can be of the contravariant coordinate of any channel, too.
   *
   * @param {Head} head
   * @param {Look} look
   */
  const channels = ({ sensors }, look) => {
    offered = [...coordinates, ...new Set(sensors.flatMap((one) => one.channels.map((name) => `M^${name}`)))];
    fillChoice(coordinate.select, offered, look.coordinate);
  };
  const nodes = { budget: coordinate.row, ellipses: plane.row, vectors: magnification.row };
  return { nodes, show, channels };
}

/**
 * @param {string} label
 * @param {Option[]} options
 * @param {(value: string) => void} on
 */
function tool(label, options, on) {
  return choice({ label, options, value: undefined, hidden: true, on });
}
