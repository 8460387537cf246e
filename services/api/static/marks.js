// Doorways, stairs and frontiers of a floor: their lines in world metres, and how they are drawn on the plan.

import { svg } from "./dom.js";

const TREAD = 0.28; // metres from one tread of a flight to the next
const JAMB = 0.09; // metres, half of what marks an end of a doorway
const TOUCHING = 0.16; // metres between the outlines of two regions that meet
const STEP = 0.05;

/** What is marked on a floor: `edges` that begin or end on it, its `frontiers`, and all regions by id. */
export function floorMarks(floor, edges, frontiers, regions) {
  const marks = [];
  for (const edge of edges) {
    const [a, b] = [regions.get(edge.a), regions.get(edge.b)];
    if (!a || !b || (a.floor !== floor && b.floor !== floor)) continue;
    if (edge.kind === "doorway") marks.push(doorway(edge, a, b));
    if (edge.kind === "stairs") marks.push(stairs(edge, floor, a.floor === floor ? b.floor : a.floor));
  }
  for (const frontier of frontiers) {
    if (frontier.floor === floor) marks.push(unexplored(frontier, regions.get(frontier.region_id)));
  }
  return marks;
}

function doorway(edge, a, b) {
  const others = samples(b.outlines);
  const shared = near(samples(a.outlines), edge.position, 0.5 * edge.width + 0.2)
    .filter((point) => others.some((other) => distance(point, other) < TOUCHING));
  const line = through(edge.position, edge.width, shared);
  const [along, across] = axes(line);
  const jambs = line.map(([x, y]) => `M${x - JAMB * across[0]} ${y - JAMB * across[1]}L${x + JAMB * across[0]} ${y + JAMB * across[1]}`);
  const threshold = `M${line[0].join(" ")}L${line[1].join(" ")}`;
  return {
    at: edge.position, text: `${edge.width.toFixed(1)} m`, klass: "of-door", away: Math.abs(along[0]) > Math.abs(along[1]),
    node: svg("g", { class: "doorway", "data-testid": "plan-doorway" },
      svg("path", { class: "gap", d: threshold }), svg("path", { class: "leaf", d: threshold + jambs.join("") })),
  };
}

function stairs(edge, floor, other) {
  const [foot, head] = [edge.position, edge.upper ?? edge.position];
  const run = [head[0] - foot[0], head[1] - foot[1]];
  const apart = Math.hypot(...run);
  const along = apart > 0 ? run.map((part) => part / apart) : [1, 0];
  const length = Math.max(apart, edge.width);
  const side = [-along[1] * edge.width * 0.5, along[0] * edge.width * 0.5];
  const at = (walked, sign = 0) => [foot[0] + walked * along[0] + sign * side[0], foot[1] + walked * along[1] + sign * side[1]];
  const steps = Math.max(2, Math.round(length / TREAD));
  const treads = Array.from({ length: steps - 1 }, (_, i) => `M${at((length * (i + 1)) / steps, -1).join(" ")}L${at((length * (i + 1)) / steps, 1).join(" ")}`);
  const rim = `M${[at(0, -1), at(length, -1), at(length, 1), at(0, 1)].map((point) => point.join(" ")).join("L")}Z`;
  const up = other > floor;
  const [from, to] = up ? [at(0), at(length)] : [at(length), at(0)];
  const back = up ? -0.2 : 0.2;
  const head2 = [-0.12, 0.12].map((sign) => [to[0] + back * along[0] - sign * along[1], to[1] + back * along[1] + sign * along[0]]);
  return {
    at: [...at(length / 2), edge.position[2]], box: bounds([at(0, -1), at(length, -1), at(length, 1), at(0, 1)]), text: `${up ? "up" : "down"} to floor ${other}`, klass: "of-stairs", away: true,
    node: svg("g", { class: "stairs", "data-testid": "plan-stairs" },
      svg("path", { class: "rim", d: rim }), svg("path", { class: "treads", d: treads.join("") }),
      svg("path", { class: "way", d: `M${from.join(" ")}L${to.join(" ")}M${head2[0].join(" ")}L${to.join(" ")}L${head2[1].join(" ")}` })),
  };
}

function unexplored(frontier, region) {
  const rim = region ? near(samples([...region.outlines, ...region.holes]), frontier.position, 0.5 * frontier.width) : [];
  const line = through(frontier.position, frontier.width, rim);
  return {
    at: frontier.position, text: "unexplored", klass: "of-frontier", away: true,
    node: svg("path", { class: "frontier", "data-testid": "plan-frontier", d: `M${line[0].join(" ")}L${line[1].join(" ")}` }),
  };
}

/** Points on rings, some centimetres apart. */
function samples(rings) {
  const points = [];
  for (const ring of rings) {
    ring.forEach((start, index) => {
      const end = ring[(index + 1) % ring.length];
      const count = Math.max(1, Math.ceil(distance(start, end) / STEP));
      for (let i = 0; i < count; i += 1) points.push([start[0] + (i / count) * (end[0] - start[0]), start[1] + (i / count) * (end[1] - start[1])]);
    });
  }
  return points;
}

/** The ends of a line of a length through `middle`, along the main direction of points; along x where there are none. */
function through(middle, length, points) {
  let [xx, xy, yy] = [0, 0, 0];
  const mean = [0, 1].map((axis) => points.reduce((sum, point) => sum + point[axis], 0) / Math.max(points.length, 1));
  for (const point of points) {
    const [x, y] = [point[0] - mean[0], point[1] - mean[1]];
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  const angle = points.length > 1 ? 0.5 * Math.atan2(2 * xy, xx - yy) : 0;
  const half = [0.5 * length * Math.cos(angle), 0.5 * length * Math.sin(angle)];
  return [[middle[0] - half[0], middle[1] - half[1]], [middle[0] + half[0], middle[1] + half[1]]];
}

function axes([start, end]) {
  const length = distance(start, end) || 1;
  const along = [(end[0] - start[0]) / length, (end[1] - start[1]) / length];
  return [along, [-along[1], along[0]]];
}

/** A box of six numbers about points of the floor, as objects have. */
function bounds(points) {
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  return [Math.min(...xs), Math.min(...ys), 0, Math.max(...xs), Math.max(...ys), 0];
}

const near = (points, middle, reach) => points.filter((point) => distance(point, middle) <= reach);
const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);
