// The floor plan: cells, regions, objects, the robot's way and the answer, in SVG.
// The world (metres, y up) is one transformed group; names and markers of constant size lie over it in pixels.

import { el, svg } from "./dom.js";
import { metres, squareMetres } from "./format.js";
import { floorMarks } from "./marks.js";

const MARGIN = 0.06;
const NICE = [0.25, 0.5, 1, 2, 5, 10, 20, 50];
const MOST_LABELS = 120;
const SMALL = 0.35; // metres; smaller things get a dot, so that they can be seen and hit

export class Plan {
  constructor(root, on) {
    this.root = root;
    this.on = on;
    this.objects = [];
    this.regions = [];
    this.marks = [];
    this.trail = [];
    this.answer = null;
    this.viewpoints = [];
    this.current = null;
    this.moved = false;
    this.view = { x: 0, y: 0, scale: 50 };
    this.world = svg("g");
    this.cells = svg("g");
    this.layers = Object.fromEntries(["regions", "marks", "trail", "objects", "path"].map((name) => [name, svg("g", { class: name })]));
    this.world.append(this.layers.regions, this.cells, this.layers.marks, this.layers.trail, this.layers.objects, this.layers.path);
    this.overlay = svg("g");
    this.svg = svg("svg", { class: "plan", tabindex: "0", role: "application", "data-testid": "plan-svg",
      "aria-label": "Floor plan. Arrow keys move it, plus and minus change the scale, 0 shows all." }, this.world, this.overlay);
    this.empty = el("p", { class: "empty", "data-testid": "plan-empty", hidden: true });
    this.tip = el("div", { class: "tip", hidden: true, "data-testid": "plan-tip" });
    root.replaceChildren(this.svg, this.empty, this.tip);
    this.listen();
  }

  /** Cells of the floor: {origin, resolution, rows, columns} and a canvas with one pixel a cell, row 0 first. */
  setCells(grid, picture) {
    this.cells.replaceChildren();
    this.grid = grid;
    if (!grid) return;
    const image = svg("image", { class: "cells", x: grid.origin[0], y: grid.origin[1], width: grid.columns * grid.resolution,
      height: grid.rows * grid.resolution, preserveAspectRatio: "none", href: picture.toDataURL() });
    this.cells.append(image);
    this.draw();
  }

  setRegions(regions) {
    this.regions = regions;
    this.layers.regions.replaceChildren(...regions.map((region) => svg("path", {
      class: "region", d: [...region.outlines, ...region.holes].map(ringPath).join(" "), "fill-rule": "evenodd",
      fill: region.color, stroke: region.color, "data-testid": "plan-region", "data-id": region.region_id,
    })));
    this.draw();
  }

  /** Doorways, stairs and frontiers of the floor shown; `regions` are those of all floors. */
  setMarks(floor, edges, frontiers, regions) {
    this.marks = floorMarks(floor, edges, frontiers, new Map(regions.map((region) => [region.region_id, region])));
    this.layers.marks.replaceChildren(...this.marks.map((mark) => mark.node));
    this.draw();
  }

  /** Brings out a region that is pointed at elsewhere; null: none. */
  point(id) {
    for (const node of this.layers.regions.children) node.toggleAttribute("data-pointed", node.dataset.id === id);
  }

  setObjects(objects, fresh = new Set()) {
    this.objects = objects;
    const bySize = [...objects].sort((a, b) => area(b.box) - area(a.box) || a.box[2] - b.box[2]);
    this.layers.objects.replaceChildren(...bySize.map((obj) => {
      const [x0, y0, , x1, y1] = obj.box;
      const d = `M${obj.position[0]} ${obj.position[1]}h0`;
      const small = Math.min(x1 - x0, y1 - y0) < SMALL;
      return svg("g", { class: "object", "data-testid": "plan-object", "data-id": obj.id, "data-label": obj.label,
        "data-new": fresh.has(obj.id) || undefined },
        svg("rect", { x: x0, y: y0, width: Math.max(x1 - x0, 0.02), height: Math.max(y1 - y0, 0.02), rx: 0.03,
          fill: `rgb(${obj.mean_color.map(Math.round).join(" ")})` }),
        ...(small ? [svg("path", { class: "dot rim", d }), svg("path", { class: "dot core", d })] : []));
    }));
    this.draw();
  }

  /** Camera positions of the recording, oldest first, and the newest pose. */
  setTrail(frames) {
    this.trail = frames;
    const d = frames.length > 1 ? linePath(frames.map((frame) => frame.position)) : null;
    this.layers.trail.replaceChildren(...(d ? [svg("path", { class: "trail", d })] : []));
    this.draw();
  }

  setAnswer(answer) {
    this.answer = answer;
    this.viewpoints = [];
    const path = answer?.path ?? [];
    this.layers.path.replaceChildren(...(path.length > 1
      ? [svg("path", { class: "path rim", d: linePath(path) }), svg("path", { class: "path core", d: linePath(path), "data-testid": "plan-path" })]
      : []));
    this.draw();
  }

  addViewpoint(viewpoint) {
    this.viewpoints.push(viewpoint);
    this.draw();
  }

  select(id) {
    this.current = id;
    for (const node of this.world.querySelectorAll("[data-current]")) node.removeAttribute("data-current");
    if (id) this.world.querySelector(`[data-id="${CSS.escape(id)}"]`)?.setAttribute("data-current", "true");
    this.draw();
  }

  say(text) {
    this.empty.textContent = text;
    this.empty.hidden = !text;
  }

  /** Shows everything there is, and goes on doing so as the map grows, until the view is moved. */
  fit() {
    this.moved = false;
    this.draw();
  }

  frameAll({ width, height }) {
    const bounds = this.bounds();
    if (!bounds) return;
    const [x0, y0, x1, y1] = bounds;
    const room = 1 - 2 * MARGIN;
    this.view = {
      x: (x0 + x1) / 2,
      y: (y0 + y1) / 2,
      scale: Math.min((room * width) / Math.max(x1 - x0, 0.5), (room * height) / Math.max(y1 - y0, 0.5), 400),
    };
  }

  zoom(factor, at = null) {
    this.moved = true;
    const { width, height } = this.svg.getBoundingClientRect();
    const [px, py] = at ?? [width / 2, height / 2];
    const [x, y] = this.worldAt(px, py);
    this.view.scale = Math.min(2000, Math.max(2, this.view.scale * factor));
    this.view.x = x - (px - width / 2) / this.view.scale;
    this.view.y = y + (py - height / 2) / this.view.scale;
    this.draw();
  }

  pan(dx, dy) {
    this.moved = true;
    this.view.x -= dx / this.view.scale;
    this.view.y += dy / this.view.scale;
    this.draw();
  }

  bounds() {
    const points = [
      ...this.regions.flatMap((region) => region.outlines.flat()),
      ...this.objects.flatMap((obj) => [obj.box.slice(0, 2), obj.box.slice(3, 5)]),
      ...this.trail.map((frame) => frame.position),
    ];
    if (!points.length) return null;
    const xs = points.map((point) => point[0]);
    const ys = points.map((point) => point[1]);
    const min = (values) => values.reduce((a, b) => Math.min(a, b));
    const max = (values) => values.reduce((a, b) => Math.max(a, b));
    return [min(xs), min(ys), max(xs), max(ys)];
  }

  draw() {
    cancelAnimationFrame(this.pending);
    this.pending = requestAnimationFrame(() => this.render());
  }

  render() {
    const { width, height } = this.svg.getBoundingClientRect();
    if (!width) return;
    if (!this.moved) this.frameAll({ width, height });
    this.size = { width, height };
    const { x, y, scale } = this.view;
    this.world.setAttribute("transform", `matrix(${scale} 0 0 ${-scale} ${width / 2 - x * scale} ${height / 2 + y * scale})`);
    this.overlay.replaceChildren(...this.markers(), ...this.names(), this.scaleBar());
  }

  /** Things of constant size on the screen: the robot, the goal, what was found, ranks of candidates, viewpoints. */
  markers() {
    const marks = [];
    const last = this.trail.at(-1);
    if (last) marks.push(this.arrow(last.position, heading(last.pose), "robot", "plan-robot"));
    for (const viewpoint of this.viewpoints) marks.push(this.arrow(viewpoint.position, viewpoint.facing, "viewpoint", "plan-viewpoint"));
    const answer = this.answer;
    if (!answer) return marks;
    if (answer.goal) {
      const [x, y] = this.screen(answer.goal.position);
      marks.push(svg("circle", { class: "goal", cx: x, cy: y, r: 6, "data-testid": "plan-goal" }));
      marks.push(this.arrow(answer.goal.position, answer.goal.facing, "goal-heading", "plan-goal-heading", 0.6, 13));
    }
    answer.candidates.slice(0, 9).forEach((candidate, index) => {
      if (candidate.id && candidate.id === answer.object?.id) return;
      const [x, y] = this.screen(candidate.position);
      marks.push(svg("g", { class: "rank", transform: `translate(${x} ${y - 16})` }, svg("circle", { r: 8 }), svg("text", { text: String(index + 1) })));
    });
    if (answer.object) {
      const [x, y] = this.screen(answer.object.position);
      marks.push(svg("circle", { class: "found pulse", cx: x, cy: y, r: 14 }));
      marks.push(svg("circle", { class: "found", cx: x, cy: y, r: 11, "data-testid": "plan-found" }));
    }
    return marks;
  }

  /** Names that do not cover each other: what is selected or found, regions, then objects from large to small. */
  names() {
    const taken = [];
    const written = [];
    const write = (text, point, klass, shift = 0, aside = 0) => {
      const [px, y] = this.screen(point);
      const x = Math.min(Math.max(px + aside, 3.4 * text.length + 4), this.size.width - 3.4 * text.length - 4);
      if (x < 0 || y < 0 || x > this.size.width || y > this.size.height) return;
      const half = 3.4 * text.length + 4;
      const place = [x - half, y + shift - 8, x + half, y + shift + 8];
      if (taken.some((other) => shared(place, other) > 0)) return;
      taken.push(place);
      written.push(svg("text", { class: klass, x, y: y + shift, text }));
    };
    const found = this.answer?.object;
    const first = this.objects.filter((obj) => obj.id === this.current || obj.id === found?.id);
    for (const obj of first) write(obj.label, obj.position, "of-object of-current", 22);
    if (found && !found.id) write(found.label, found.position, "of-object of-current", 22);
    const writeMark = (mark) => write(mark.text, mark.at, mark.klass, mark.away ? -12 : 0, mark.away ? 0 : 22);
    for (const mark of this.marks.filter((other) => other.box)) writeMark(mark);
    for (const region of this.regions) {
      const at = this.roomFor(region, taken);
      if (!at) continue;
      write(region.display_name, at, "of-region", -8);
      write(squareMetres(region.area), at, "of-area", 8);
    }
    for (const mark of this.marks.filter((other) => !other.box)) writeMark(mark);
    const rest = this.objects.filter((obj) => !first.includes(obj)).sort((a, b) => area(b.box) - area(a.box));
    for (const obj of rest.slice(0, MOST_LABELS)) {
      const fits = (obj.box[3] - obj.box[0]) * this.view.scale > 7 * obj.label.length;
      write(obj.label, obj.position, "of-object", fits ? 0 : 13);
    }
    return written;
  }

  /** A place inside the region for its name and area: near its middle, off what is written, beside the objects. */
  roomFor(region, taken) {
    const half = 4.2 * region.display_name.length + 4;
    const [cx, cy] = this.screen(region.centroid);
    const boxes = [...this.objects, ...this.marks].filter(({ box }) => box)
      .map(({ box }) => [...this.screen([box[0], box[4]]), ...this.screen([box[3], box[1]])]);
    let best = { cost: Infinity, at: null };
    for (const dx of [0, -50, 50, -100, 100, -160, 160]) {
      for (const dy of [0, 36, -36, 72, -72, 110, -110, 150, -150]) {
        const place = [cx + dx - half, cy + dy - 17, cx + dx + half, cy + dy + 17];
        const at = this.worldAt(cx + dx, cy + dy);
        if (!region.outlines.some((ring) => inside(ring, at)) || taken.some((other) => shared(place, other) > 0)) continue;
        const over = this.corners(place).filter((point) => !region.outlines.some((ring) => inside(ring, point))).length;
        const cost = boxes.reduce((sum, box) => sum + shared(place, box), 0) + 700 * over + 2 * Math.hypot(dx, dy);
        if (cost < best.cost) best = { cost, at };
      }
    }
    return best.at;
  }

  corners([x0, y0, x1, y1]) {
    return [[x0, y0], [x1, y0], [x0, y1], [x1, y1]].map(([x, y]) => this.worldAt(x, y));
  }

  scaleBar() {
    const length = NICE.find((metre) => metre * this.view.scale > 56) ?? 100;
    const y = this.size.height - 16;
    return svg("g", { class: "scale-bar" },
      svg("path", { d: `M16 ${y - 5}v5h${length * this.view.scale}v-5` }),
      svg("text", { x: 16 + (length * this.view.scale) / 2, y: y - 9, text: length < 1 ? `${length * 100} cm` : metres(length).replace(".0", "") }));
  }

  arrow(point, direction, klass, testid, size = 1, ahead = 0) {
    const [x, y] = this.screen(point);
    const degrees = (-Math.atan2(direction[1], direction[0]) * 180) / Math.PI;
    return svg("path", { class: klass, "data-testid": testid, d: "M11 0L-7 7L-3 0L-7 -7Z",
      transform: `translate(${x} ${y}) rotate(${degrees}) translate(${ahead} 0) scale(${size})` });
  }

  screen(point) {
    return [this.size.width / 2 + (point[0] - this.view.x) * this.view.scale, this.size.height / 2 - (point[1] - this.view.y) * this.view.scale];
  }

  worldAt(px, py) {
    const { width, height } = this.size ?? this.svg.getBoundingClientRect();
    return [this.view.x + (px - width / 2) / this.view.scale, this.view.y - (py - height / 2) / this.view.scale];
  }

  listen() {
    new ResizeObserver(() => this.draw()).observe(this.svg);
    this.svg.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), this.local(event));
    }, { passive: false });
    let grip = null;
    this.svg.addEventListener("pointerdown", (event) => {
      grip = { x: event.clientX, y: event.clientY, far: false, node: thingAt(event.target) };
      this.svg.setPointerCapture(event.pointerId);
    });
    this.svg.addEventListener("pointermove", (event) => {
      if (!grip) {
        this.hover(event);
        return;
      }
      const [dx, dy] = [event.clientX - grip.x, event.clientY - grip.y];
      if (!grip.far && Math.hypot(dx, dy) < 4) return;
      grip.far = true;
      [grip.x, grip.y] = [event.clientX, event.clientY];
      this.tip.hidden = true;
      this.pan(dx, dy);
    });
    this.svg.addEventListener("pointerup", () => {
      if (grip && !grip.far) this.on.pick(grip.node?.dataset.id ?? null);
      grip = null;
    });
    this.svg.addEventListener("pointercancel", () => (grip = null));
    this.svg.addEventListener("pointerleave", () => {
      this.tip.hidden = true;
      this.point(null);
    });
    this.svg.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    const steps = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] };
    if (steps[event.key]) this.pan(...steps[event.key]);
    else if (event.key === "+" || event.key === "=") this.zoom(1.3);
    else if (event.key === "-") this.zoom(1 / 1.3);
    else if (event.key === "0") this.fit();
    else return;
    event.preventDefault();
  }

  hover(event) {
    const id = thingAt(event.target)?.dataset.id;
    const obj = id && this.objects.find((candidate) => candidate.id === id);
    const region = id && this.regions.find((candidate) => candidate.region_id === id);
    this.point(region?.region_id ?? null);
    this.tip.hidden = !obj && !region;
    if (this.tip.hidden) return;
    const [x, y] = this.local(event);
    this.tip.replaceChildren(
      el("b", { text: obj ? obj.label : region.display_name }), obj ? this.on.describe(obj) : this.on.describeRegion(region));
    const half = this.tip.offsetWidth / 2 + 4;
    this.tip.style.left = `${Math.min(Math.max(x, half), this.size.width - half)}px`;
    this.tip.style.top = `${Math.max(y, this.tip.offsetHeight + 16)}px`;
  }

  local(event) {
    const { left, top } = this.svg.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }
}

/**
 * Cells as a picture of one pixel each: what is occupied is wall, but on a region's floor a thing that stands there.
 * image: grey values as the API gives them; grid: what they mean.
 */
export function paintCells(image, grid, regions, { wall, thing }) {
  const floor = floorMask(image, grid, regions);
  const canvas = el("canvas", { width: image.width, height: image.height });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(image, 0, 0);
  const pixels = context.getImageData(0, 0, image.width, image.height);
  for (let i = 0; i < pixels.data.length; i += 4) {
    const occupied = pixels.data[i] === grid.occupancy_values.occupied;
    pixels.data.set(occupied ? (floor[i + 3] > 127 ? thing : wall) : [0, 0, 0, 0], i);
  }
  context.putImageData(pixels, 0, 0);
  return canvas;
}

/** RGBA of a picture of the grid with the regions' floor filled. */
function floorMask(image, { origin, resolution }, regions) {
  const canvas = el("canvas", { width: image.width, height: image.height });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.setTransform(1 / resolution, 0, 0, 1 / resolution, -origin[0] / resolution, -origin[1] / resolution);
  for (const region of regions) context.fill(new Path2D([...region.outlines, ...region.holes].map(ringPath).join(" ")), "evenodd");
  return context.getImageData(0, 0, image.width, image.height).data;
}

/** Area that two rectangles (x0, y0, x1, y1) share. */
function shared(a, b) {
  return Math.max(0, Math.min(a[2], b[2]) - Math.max(a[0], b[0])) * Math.max(0, Math.min(a[3], b[3]) - Math.max(a[1], b[1]));
}

/** Whether a point lies in a ring of points (even-odd rule). */
function inside(ring, [x, y]) {
  let odd = false;
  for (let i = 0, j = ring.length - 1; i < ring.length; j = i, i += 1) {
    const [[xi, yi], [xj, yj]] = [ring[i], ring[j]];
    if (yi > y !== yj > y && x < ((xj - xi) * (y - yi)) / (yj - yi) + xi) odd = !odd;
  }
  return odd;
}

const thingAt = (node) => node.closest?.(".object, .region");
const area = (box) => (box[3] - box[0]) * (box[4] - box[1]);
const ringPath = (ring) => `M${ring.map((point) => `${point[0]} ${point[1]}`).join("L")}Z`;
const linePath = (points) => `M${points.map((point) => `${point[0]} ${point[1]}`).join("L")}`;
const heading = (pose) => [pose[0][2], pose[1][2]];
