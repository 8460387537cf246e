// The scene in 3D: points, boxes, region floors and the answer. Drawn only when something changed.

import * as three from "./vendor/three.module.min.js";
import { OrbitControls } from "./vendor/OrbitControls.js";
import { el } from "./dom.js";

const GOLDEN = 0.61803398875;
const VIEW_FROM = new three.Vector3(-0.22, -0.8, 0.75).normalize();
const EDGES = [0, 1, 1, 3, 3, 2, 2, 0, 4, 5, 5, 7, 7, 6, 6, 4, 0, 4, 1, 5, 2, 6, 3, 7];

export class Space {
  constructor(root, on) {
    this.root = root;
    this.on = on;
    this.paint = "seen";
    this.objects = [];
    this.regions = [];
    this.floors = [];
    this.colors = new Map();
    this.empty = el("p", { class: "empty", "data-testid": "space-empty", hidden: true });
    this.tag = el("div", { class: "tag3d", hidden: true });
    root.append(this.empty, this.tag);
    try {
      this.start();
    } catch {
      this.say("This browser draws no WebGL. The floor plan shows the same map.");
    }
  }

  start() {
    three.ColorManagement.enabled = false;
    this.renderer = new three.WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.outputColorSpace = three.LinearSRGBColorSpace;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.domElement.setAttribute("data-testid", "space-canvas");
    this.renderer.domElement.setAttribute("aria-label", "3D view of the map: drag to turn, right drag to move, wheel to zoom");
    this.renderer.domElement.setAttribute("role", "img");
    this.root.prepend(this.renderer.domElement);
    this.camera = new three.PerspectiveCamera(45, 1, 0.05, 500);
    this.camera.up.set(0, 0, 1);
    this.scene = new three.Scene();
    this.groups = Object.fromEntries(["floors", "points", "boxes", "answer", "current"].map((name) => [name, new three.Group()]));
    this.scene.add(...Object.values(this.groups));
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.maxPolarAngle = 0.52 * Math.PI;
    this.controls.addEventListener("start", () => (this.moved = true));
    this.controls.addEventListener("change", () => this.draw());
    this.ready = true;
    new ResizeObserver(() => this.resize()).observe(this.root);
    let down = null;
    this.renderer.domElement.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    this.renderer.domElement.addEventListener("pointerup", (event) => {
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) this.on.pick(this.objectUnder(event));
    });
    this.resize();
  }

  /** Points as the API packs them (see /points): header, N x 3 float32, N uint32, N x 3 uint8, JSON. */
  setPoints(buffer) {
    const head = new DataView(buffer);
    const count = head.getUint32(16, true);
    this.cloud = {
      count,
      xyz: new Float32Array(buffer, 24, 3 * count),
      owner: new Uint32Array(buffer, 24 + 12 * count, count),
      rgb: new Uint8Array(buffer, 24 + 16 * count, 3 * count),
      ids: JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 24 + 19 * count))),
    };
    this.root.dataset.points = String(count);
    if (!this.ready) return;
    this.drawPoints();
  }

  setObjects(objects) {
    this.objects = objects;
    objects.forEach((obj, index) => this.colors.set(obj.id, hue((index * GOLDEN) % 1)));
    if (!this.ready) return;
    clear(this.groups.boxes);
    if (objects.length) this.groups.boxes.add(boxLines(objects, this.ink()));
    if (this.paint !== "seen") this.drawPoints();
    if (!this.moved) this.fit();
    this.draw();
  }

  setRegions(regions, floors) {
    this.regions = regions;
    this.floors = floors;
    if (!this.ready) return;
    clear(this.groups.floors);
    const heights = this.heights();
    for (const region of regions) {
      const material = new three.MeshBasicMaterial({ color: region.color, transparent: true, opacity: 0.22, side: three.DoubleSide, depthWrite: false });
      for (const outline of region.outlines) {
        const mesh = new three.Mesh(new three.ShapeGeometry(shape(outline, region.holes)), material);
        mesh.position.z = heights.get(region.floor) ?? 0;
        this.groups.floors.add(mesh);
      }
    }
    if (this.paint === "region") this.drawPoints();
    if (!this.moved) this.fit();
    this.draw();
  }

  setPaint(paint) {
    this.paint = paint;
    if (this.ready && this.cloud) this.drawPoints();
  }

  setAnswer(answer) {
    this.answer = answer;
    if (!this.ready) return;
    clear(this.groups.answer);
    const accent = this.accent();
    if (answer?.path.length > 1) this.groups.answer.add(tube(answer.path, accent));
    if (answer?.goal) this.groups.answer.add(cone(answer.goal, accent));
    if (answer?.object) this.groups.answer.add(beacon(answer.object.position, accent));
    this.draw();
  }

  select(obj) {
    this.current = obj;
    if (!this.ready) return;
    clear(this.groups.current);
    if (obj?.box) this.groups.current.add(...solidBox(obj.box, this.accent()));
    this.draw();
  }

  /** Shows everything there is, and goes on doing so as the map grows, until the view is moved. */
  fit() {
    if (!this.ready) return;
    this.moved = false;
    const box = new three.Box3();
    for (const obj of this.objects) box.union(new three.Box3(new three.Vector3(...obj.box.slice(0, 3)), new three.Vector3(...obj.box.slice(3))));
    const heights = this.heights();
    for (const region of this.regions) {
      const z = heights.get(region.floor) ?? 0;
      for (const [x, y] of region.outlines.flat()) box.expandByPoint(new three.Vector3(x, y, z));
    }
    if (box.isEmpty()) return;
    const center = box.getCenter(new three.Vector3());
    this.camera.position.copy(center).add(VIEW_FROM);
    this.camera.lookAt(center);
    const up = Math.tan((this.camera.fov * Math.PI) / 360);
    const turn = this.camera.quaternion.clone().invert();
    let away = 1;
    for (let corner = 0; corner < 8; corner += 1) {
      const at = new three.Vector3(...["x", "y", "z"].map((axis, bit) => ((corner >> bit) & 1 ? box.max[axis] : box.min[axis])));
      const { x, y, z } = at.sub(center).applyQuaternion(turn);
      away = Math.max(away, z + Math.max(Math.abs(y) / up, Math.abs(x) / (up * this.camera.aspect)));
    }
    this.controls.target.copy(center);
    this.camera.position.copy(center).addScaledVector(VIEW_FROM, 1.05 * away);
    this.controls.update();
    this.draw();
  }

  heights() {
    return new Map(this.floors.map((floor) => [floor.floor, floor.z ?? 0]));
  }

  say(text) {
    this.empty.textContent = text;
    this.empty.hidden = !text;
  }

  /** Colours of the page changed from light to dark or back. */
  restyle() {
    this.setObjects(this.objects);
    this.setAnswer(this.answer);
    this.select(this.current);
  }

  drawPoints() {
    clear(this.groups.points);
    const { cloud } = this;
    const geometry = new three.BufferGeometry();
    geometry.setAttribute("position", new three.BufferAttribute(cloud.xyz, 3));
    geometry.setAttribute("color", new three.BufferAttribute(this.pointColors(), 3, true));
    this.groups.points.add(new three.Points(geometry, new three.PointsMaterial({ size: 0.032, vertexColors: true })));
    this.draw();
  }

  pointColors() {
    const { cloud } = this;
    if (this.paint === "seen") return cloud.rgb;
    const regionOf = new Map(this.regions.flatMap((region) => region.object_ids.map((id) => [id, hexBytes(region.color)])));
    const table = cloud.ids.map((id) => (this.paint === "region" ? regionOf.get(id) : this.colors.get(id)) ?? [150, 155, 160]);
    const colors = new Uint8Array(3 * cloud.count);
    for (let i = 0; i < cloud.count; i += 1) colors.set(table[cloud.owner[i]], 3 * i);
    return colors;
  }

  objectUnder(event) {
    const { left, top, width, height } = this.renderer.domElement.getBoundingClientRect();
    const at = new three.Vector2(((event.clientX - left) / width) * 2 - 1, 1 - ((event.clientY - top) / height) * 2);
    const caster = new three.Raycaster();
    caster.setFromCamera(at, this.camera);
    const hits = this.objects.filter((obj) => caster.ray.intersectsBox(new three.Box3(new three.Vector3(...obj.box.slice(0, 3)), new three.Vector3(...obj.box.slice(3)))));
    // Of all boxes on the ray the smallest is meant: a mug on a table, not the table.
    hits.sort((a, b) => size(a.box) - size(b.box));
    return hits[0]?.id ?? null;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.root;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (!this.moved) this.fit();
    this.draw();
  }

  draw() {
    if (!this.ready || this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.renderer.render(this.scene, this.camera);
      this.placeTag();
      this.root.dataset.drawn = String(Number(this.root.dataset.drawn ?? 0) + 1);
    });
  }

  placeTag() {
    const obj = this.current ?? this.answer?.object;
    this.tag.hidden = !obj;
    if (!obj) return;
    const top = obj.box ? [...obj.position.slice(0, 2), obj.box[5]] : obj.position;
    const place = new three.Vector3(...top).project(this.camera);
    this.tag.hidden = place.z > 1;
    this.tag.textContent = obj.label;
    const half = this.tag.offsetWidth / 2;
    const x = ((place.x + 1) / 2) * this.root.clientWidth;
    this.tag.style.left = `${Math.min(Math.max(x, half), this.root.clientWidth - half)}px`;
    this.tag.style.top = `${((1 - place.y) / 2) * this.root.clientHeight}px`;
  }

  ink() {
    return cssColor("--ink");
  }

  accent() {
    return cssColor("--accent");
  }
}

function boxLines(objects, ink) {
  const positions = new Float32Array(objects.length * EDGES.length * 3);
  objects.forEach(({ box }, index) => {
    EDGES.forEach((corner, k) => {
      const at = 3 * (index * EDGES.length + k);
      for (let axis = 0; axis < 3; axis += 1) positions[at + axis] = box[(corner >> axis) & 1 ? axis + 3 : axis];
    });
  });
  const geometry = new three.BufferGeometry();
  geometry.setAttribute("position", new three.BufferAttribute(positions, 3));
  return new three.LineSegments(geometry, new three.LineBasicMaterial({ color: ink, transparent: true, opacity: 0.28 }));
}

function solidBox(box, color) {
  const sides = [0, 1, 2].map((axis) => Math.max(box[axis + 3] - box[axis], 0.01) + 0.02);
  const geometry = new three.BoxGeometry(...sides);
  const body = new three.Mesh(geometry, new three.MeshBasicMaterial({ color, transparent: true, opacity: 0.18, depthWrite: false }));
  const edges = new three.LineSegments(new three.EdgesGeometry(geometry), new three.LineBasicMaterial({ color }));
  for (const part of [body, edges]) part.position.set(...[0, 1, 2].map((axis) => (box[axis] + box[axis + 3]) / 2));
  return [body, edges];
}

function tube(path, color) {
  const curve = new three.CurvePath();
  for (let i = 1; i < path.length; i += 1) {
    const [from, to] = [path[i - 1], path[i]].map(([x, y, z]) => new three.Vector3(x, y, z + 0.03));
    if (from.distanceTo(to) > 1e-4) curve.add(new three.LineCurve3(from, to));
  }
  return new three.Mesh(new three.TubeGeometry(curve, 8 * path.length, 0.025, 6), new three.MeshBasicMaterial({ color }));
}

function cone(goal, color) {
  const mesh = new three.Mesh(new three.ConeGeometry(0.1, 0.28, 16), new three.MeshBasicMaterial({ color }));
  mesh.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), new three.Vector3(...goal.facing));
  mesh.position.set(goal.position[0], goal.position[1], goal.position[2] + 0.1);
  return mesh;
}

/** A thin line above what was found, so that it is seen from afar. */
function beacon([x, y, z], color) {
  const geometry = new three.BufferGeometry().setFromPoints([new three.Vector3(x, y, z), new three.Vector3(x, y, z + 1.2)]);
  return new three.Line(geometry, new three.LineBasicMaterial({ color, transparent: true, opacity: 0.8 }));
}

function shape(outline, holes) {
  const ring = (points) => points.map(([x, y]) => new three.Vector2(x, y));
  const outer = new three.Shape(ring(outline));
  outer.holes = holes.map((hole) => new three.Path(ring(hole)));
  return outer;
}

function clear(group) {
  for (const child of [...group.children]) {
    group.remove(child);
    child.geometry?.dispose();
    child.material?.dispose();
  }
}

function hue(turn) {
  const color = new three.Color().setHSL(turn, 0.55, 0.55);
  return [color.r, color.g, color.b].map((value) => Math.round(255 * value));
}

const hexBytes = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
const cssColor = (name) => new three.Color(getComputedStyle(document.documentElement).getPropertyValue(name).trim());
const size = (box) => [0, 1, 2].reduce((product, axis) => product * Math.max(box[axis + 3] - box[axis], 0.01), 1);
