// Numbers and places in words.

export const metres = (value) => `${value < 10 ? value.toFixed(1) : Math.round(value)} m`;
export const squareMetres = (value) => `${value < 10 ? value.toFixed(1) : Math.round(value)} m²`;
export const millis = (value) => (value < 10 ? `${value.toFixed(1)} ms` : value < 1000 ? `${Math.round(value)} ms` : `${(value / 1000).toFixed(1)} s`);
export const position = (p) => p.map((value) => value.toFixed(2)).join(", ");
export const plural = (count, word) => `${count.toLocaleString("en")} ${word}${count === 1 ? "" : "s"}`;
export const percent = (share) => `${Math.round(100 * share)} %`;

/** Length of a polyline of points. */
export function pathLength(path) {
  let sum = 0;
  for (let i = 1; i < path.length; i += 1) sum += distance(path[i - 1], path[i]);
  return sum;
}

/** Width, depth and height of a box of six numbers. */
export const extents = (box) => [box[3] - box[0], box[4] - box[1], box[5] - box[2]];

export const volume = (box) => extents(box).reduce((product, side) => product * Math.max(side, 0.01), 1);

/** Metres between two boxes; 0 where they touch. */
export function gap(a, b) {
  let sum = 0;
  for (let axis = 0; axis < 3; axis += 1) {
    const apart = Math.max(0, a[axis] - b[axis + 3], b[axis] - a[axis + 3]);
    sum += apart * apart;
  }
  return Math.sqrt(sum);
}

/** "In the kitchen, on the dining table": the region that holds it, and what it stands on or is nearest to. */
export function placeInWords(candidate, objects, regionOf) {
  const box = candidate.box ?? [...candidate.position, ...candidate.position];
  const larger = [...objects.values()].filter((other) => other.id !== candidate.id && volume(other.box) > 1.5 * volume(box));
  const region = candidate.id ? regionOf(candidate.id) : null;
  const words = [];
  if (region) words.push(region.function === "unknown" ? `in ${region.display_name}` : `in the ${region.display_name}`);
  const beside = besideWhat(box, larger);
  if (beside) words.push(beside);
  return words.join(", ");
}

function besideWhat(box, others) {
  const under = best(others, (other) => (standsOn(box, other.box) ? -overlap(box, other.box) : 0));
  if (under && under.cost < -0.6) return `on the ${under.other.label}`;
  const nearest = best(others, (other) => gap(box, other.box) - 0.01 * overlap(box, other.box));
  if (!nearest || nearest.cost > 3) return "";
  return nearest.cost < 0.15 ? `at the ${nearest.other.label}` : `${metres(nearest.cost)} from the ${nearest.other.label}`;
}

/** Whether a thing rises above another and does not reach down beside it, as a chair does at a table. */
function standsOn(box, other) {
  const lowest = other[2] + 0.3 * (other[5] - other[2]) - 0.05;
  return box[5] > other[5] - 0.05 && box[2] > lowest && gap(box, other) < 0.1;
}

/** The cheapest of `others`, the larger of equals. */
function best(others, costOf) {
  let found = null;
  for (const other of others) {
    const cost = costOf(other);
    if (!found || cost < found.cost || (cost === found.cost && volume(other.box) > volume(found.other.box))) found = { other, cost };
  }
  return found;
}

/** Share of the footprint of `a` that lies over that of `b`, 0..1. */
function overlap(a, b) {
  const sides = [0, 1].map((axis) => Math.min(a[axis + 3], b[axis + 3]) - Math.max(a[axis], b[axis]));
  const own = [0, 1].map((axis) => Math.max(a[axis + 3] - a[axis], 0.01));
  return (Math.max(sides[0], 0) * Math.max(sides[1], 0)) / (own[0] * own[1]);
}

function distance(a, b) {
  return Math.hypot(...a.map((value, axis) => value - b[axis]));
}
