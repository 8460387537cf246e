// The page: which scene is shown, what is asked, what is selected. Everything else is told what to draw.

import { adoptKey, ask, follow, getBytes, getImage, getJson, link, Problem, setKey } from "./api.js";
import { AnswerPanel } from "./answer.js";
import { byId, el, paced } from "./dom.js";
import { extents, metres, plural, squareMetres } from "./format.js";
import { paintCells, Plan } from "./plan.js";
import { Space } from "./space.js";

const PAGE = 1000;
const MOST_FRAMES = 4000;
const MOST_POINTS = 150_000;
const SUGGESTED = 8;
const MOST_CHANGES = 3;
const WIDE = 1.6;
const SCENES_EVERY_MS = 5000;

const state = {
  scene: null, wanted: null, version: 0, objects: new Map(), regions: [], floors: [], edges: [], frontiers: [], regionNames: new Map(), floor: 0, regionOf: new Map(), frames: [], framesEnd: null,
  regionsRevision: -1, stop: () => {}, asking: null,
};

const plan = new Plan(byId("plan"), { pick: (id) => select(id), describe: (obj) => describe(obj), describeRegion: (region) => describeRegion(region) });
const space = new Space(byId("space"), { pick: (id) => select(id) });
const answers = new AnswerPanel(byId("panel-answer"), {
  image: (frameId) => getImage(`v1/scenes/${state.scene}/frames/${frameId}/rgb`),
  pick: (id, candidate) => select(id, candidate),
});

const refreshMap = paced(() => attempt(loadObjects), 350);
const refreshRegions = paced(() => attempt(loadRegions), 350);
const refreshPoints = paced(() => attempt(loadPoints), 1500);
const refreshFrames = paced(() => attempt(loadFrames), 700);

adoptKey();
wire();
await attempt(start);

/** Everything from the list of scenes on; called again when the key or the connection came back. */
async function start() {
  const { scenes } = await getJson("v1/scenes");
  byId("key-dialog").close();
  showSystem();
  const names = scenes.map((scene) => scene.scene);
  listScenes(names);
  byId("find").disabled = byId("question").disabled = byId("export").hidden = !scenes.length;
  if (!scenes.length) {
    notice("No scene yet. Stream a recording into the stack: ovip replay PATH --layout 7scenes --scene kitchen. This page looks again by itself.", "hint");
    plan.say("Nothing mapped yet.");
    setTimeout(() => attempt(start), 3000);
    return;
  }
  notice("");
  state.wanted = new URL(location.href).searchParams.get("scene");
  await open(names.includes(state.wanted) ? state.wanted : names[0]);
}

/** New scenes join the list by themselves; one that the address named before it existed is opened when it comes. */
async function lookForScenes() {
  if (!state.scene || document.hidden) return;
  const names = (await getJson("v1/scenes")).scenes.map((scene) => scene.scene);
  listScenes(names);
  if (state.wanted && state.wanted !== state.scene && names.includes(state.wanted)) await open(state.wanted);
}

function listScenes(names) {
  const picker = byId("scene");
  picker.disabled = !names.length;
  if (names.join() === [...picker.options].map((option) => option.value).join()) return;
  picker.replaceChildren(...names.map((name) => el("option", { value: name, text: name })));
  if (state.scene) picker.value = state.scene;
}

async function open(scene) {
  state.stop();
  state.asking?.abort();
  byId("scene").value = scene;
  Object.assign(state, { scene, version: 0, objects: new Map(), regions: [], floors: [], edges: [], frontiers: [], regionNames: new Map(), floor: 0, frames: [], framesEnd: null, regionsRevision: -1 });
  plan.moved = space.moved = false;
  for (const view of [plan, space]) view.setAnswer(null);
  select(null);
  answers.idle();
  tellChanges([]);
  showExports();
  await Promise.all([loadObjects(), loadRegions(), loadFrames()]);
  await loadPoints();
  if (scene !== state.scene) return;
  state.stop = follow(scene, state.version, {
    state: (connection) => live(connection),
    map: (delta) => {
      state.version = delta.version;
      showFacts();
      refreshMap();
      refreshPoints();
      refreshFrames();
    },
    regions: ({ revision, events }) => {
      if (revision === state.regionsRevision) return;
      tellChanges(events);
      refreshRegions();
    },
  });
}

async function loadObjects() {
  const { scene } = state;
  const objects = new Map();
  let cursor = null;
  let version = 0;
  do {
    const page = await getJson(`v1/scenes/${scene}/objects`, { limit: PAGE, ...(cursor ? { cursor } : {}) });
    for (const obj of page.objects) objects.set(obj.id, obj);
    ({ next_cursor: cursor, map_version: version } = page);
  } while (cursor);
  if (scene !== state.scene) return;
  const known = state.objects;
  const fresh = new Set(known.size ? [...objects.keys()].filter((id) => !known.has(id)) : []);
  state.objects = objects;
  state.version = Math.max(state.version, version);
  showObjects(fresh);
  showFacts();
}

async function loadRegions() {
  const { scene } = state;
  const body = await getJson(`v1/scenes/${scene}/regions`);
  if (scene !== state.scene) return;
  state.regions = body.regions;
  state.floors = body.floors;
  state.edges = body.edges;
  state.frontiers = body.frontiers;
  for (const region of body.regions) state.regionNames.set(region.region_id, region.display_name);
  state.regionsRevision = body.regions_revision;
  state.regionOf = new Map(body.regions.flatMap((region) => region.object_ids.map((id) => [id, region])));
  if (!body.floors.some((floor) => floor.floor === state.floor)) state.floor = body.floors[0]?.floor ?? 0;
  const picker = byId("floor");
  picker.hidden = body.floors.length < 2;
  picker.replaceChildren(...body.floors.map((floor) => el("option", { value: floor.floor, text: `Floor ${floor.floor}, at ${(floor.z ?? 0).toFixed(1)} m` })));
  picker.value = state.floor;
  showRegions();
  showObjects();
  showFacts();
  await loadGrid();
}

async function loadGrid() {
  const { scene, floor } = state;
  if (!state.floors.length) {
    plan.setCells(null);
    return;
  }
  const grid = await getJson(`v1/scenes/${scene}/grid/${floor}`);
  const image = await getImage(grid.occupancy_png);
  if (scene !== state.scene || floor !== state.floor) return;
  state.cells = { grid, image };
  showCells();
}

async function loadFrames() {
  const { scene } = state;
  let cursor = state.framesEnd;
  do {
    const page = await getJson(`v1/scenes/${scene}/frames`, { limit: PAGE, ...(cursor ? { cursor } : {}) });
    if (scene !== state.scene) return;
    state.frames.push(...page.frames);
    state.framesEnd = page.end_cursor ?? state.framesEnd;
    cursor = page.next_cursor;
  } while (cursor && state.frames.length < MOST_FRAMES);
  plan.setTrail(state.frames);
  showFacts();
}

async function loadPoints() {
  const { scene } = state;
  const buffer = await getBytes(`v1/scenes/${scene}/points`, { max_points: MOST_POINTS });
  if (scene === state.scene) space.setPoints(buffer);
}

async function find(text) {
  state.asking?.abort();
  const asking = (state.asking = new AbortController());
  show("answer");
  answers.begin(text);
  for (const view of [plan, space]) view.setAnswer(null);
  select(null);
  byId("find").disabled = true;
  try {
    for await (const [name, body] of ask(state.scene, { text }, asking.signal)) {
      if (name === "tier_started") answers.tierStarted(body.tier);
      else if (name === "tier_finished") answers.tierFinished(body);
      else if (name === "viewpoint") plan.addViewpoint(body);
      else if (name === "answer") finish(body);
      else if (name === "problem") answers.fail(new Problem(body.status, body.detail));
    }
  } catch (problem) {
    if (problem.name === "AbortError") return;
    answers.fail(problem);
    if (problem.status === 401) askForKey();
  } finally {
    if (state.asking === asking) byId("find").disabled = false;
  }
}

function finish(answer) {
  answers.finish(answer, { objects: state.objects, regionOf: (id) => state.regionOf.get(id) });
  if (answer.object) select(answer.object.id, answer.object);
  plan.setAnswer(answer);
  space.setAnswer(answer);
}

/** Marks one object everywhere; a candidate that is no mapped object is marked where it is. */
function select(id, candidate = null) {
  const obj = (id && state.objects.get(id)) || candidate;
  if (obj?.id) showFloorOf(obj.id);
  if (!obj && id) show("regions");
  plan.select(id);
  space.select(obj);
  for (const row of document.querySelectorAll(".row[data-id]")) {
    const here = row.dataset.id === id;
    row.toggleAttribute("aria-current", false);
    if (here) {
      row.setAttribute("aria-current", "true");
      row.scrollIntoView({ block: "nearest" });
    }
  }
}

function showFloorOf(id) {
  const region = state.regionOf.get(id);
  if (region && region.floor !== state.floor) changeFloor(region.floor);
}

function changeFloor(floor) {
  state.floor = floor;
  byId("floor").value = floor;
  plan.moved = false;
  showRegions();
  showObjects();
  showExports();
  attempt(loadGrid);
}

function showObjects(fresh) {
  const objects = [...state.objects.values()];
  const here = objects.filter((obj) => (state.regionOf.get(obj.id)?.floor ?? state.floor) === state.floor);
  plan.setObjects(here, fresh);
  plan.say(objects.length ? "" : "No objects yet: an object appears once it was seen often enough.");
  space.setObjects(objects);
  split();
  byId("object-count").textContent = objects.length;
  const wanted = byId("filter").value.trim().toLowerCase();
  const listed = objects.filter((obj) => obj.label.toLowerCase().includes(wanted)).sort((a, b) => a.label.localeCompare(b.label) || (a.id < b.id ? -1 : 1));
  byId("object-rows").replaceChildren(...listed.map(objectRow));
  if (!listed.length) byId("object-rows").append(el("li", { class: "quiet", text: objects.length ? "No object has such a name." : "No objects yet." }));
  suggest(objects);
}

/** A wide scene is shown with the plan above the 3D view, any other with both side by side. */
function split() {
  const bounds = plan.bounds();
  const wide = bounds && bounds[2] - bounds[0] > WIDE * (bounds[3] - bounds[1]);
  byId("stage").dataset.split = wide ? "rows" : "columns";
}

function objectRow(obj) {
  const swatch = el("span", { class: "swatch" });
  swatch.style.background = `rgb(${obj.mean_color.map(Math.round).join(" ")})`;
  return el("li", {}, el("button", { class: "row", type: "button", "data-testid": "object-item", "data-id": obj.id, onclick: () => select(obj.id) },
    swatch,
    el("span", {}, el("span", { class: "name", text: obj.label }), " ", el("span", { class: "where", text: state.regionOf.get(obj.id)?.display_name ?? "" })),
    el("span", { class: "side-note", text: `seen ${obj.frames}×` })));
}

function showRegions() {
  plan.setRegions(state.regions.filter((region) => region.floor === state.floor));
  plan.setMarks(state.floor, state.edges, state.frontiers, state.regions);
  space.setRegions(state.regions, state.floors);
  byId("region-count").textContent = state.regions.length;
  byId("region-rows").replaceChildren(...state.regions.map(regionRow));
  if (!state.regions.length) byId("region-rows").append(el("li", { class: "quiet", text: "No regions yet: they are cut once enough floor was seen." }));
}

function regionRow(region) {
  const swatch = el("span", { class: "swatch" });
  swatch.style.background = region.color;
  const ways = neighbours(region);
  return el("li", {}, el("button", {
    class: "row", type: "button", "data-testid": "region-item", "data-id": region.region_id,
    onmouseenter: () => plan.point(region.region_id), onmouseleave: () => plan.point(null),
    onclick: () => {
      if (region.floor !== state.floor) changeFloor(region.floor);
      select(region.region_id);
    },
  },
  swatch,
  el("span", {},
    el("span", { class: "name", text: region.display_name }), " ",
    el("span", { class: "where", text: [!region.display_name.startsWith(region.function) && region.function, plural(region.object_ids.length, "object"), state.floors.length > 1 && `floor ${region.floor}`].filter(Boolean).join(" · ") }),
    ways && el("span", { class: "where ways", "data-testid": "region-ways", text: ways })),
  el("span", { class: "side-note", text: squareMetres(region.area) })));
}

/** "doorway 0.9 m to kitchen, open to dining area". */
function neighbours(region) {
  const said = { doorway: (edge) => `doorway ${metres(edge.width)} to`, opening: () => "open to", stairs: () => "stairs to" };
  return state.edges.filter((edge) => edge.a === region.region_id || edge.b === region.region_id)
    .map((edge) => `${said[edge.kind](edge)} ${nameOf(edge.a === region.region_id ? edge.b : edge.a)}`).join(", ");
}

function describeRegion(region) {
  return [squareMetres(region.area), plural(region.object_ids.length, "object"), neighbours(region)].filter(Boolean).join(" · ");
}

function nameOf(id) {
  return state.regionNames.get(id) ?? id;
}

/** What a new partition changed, in words above the plan. */
function tellChanges(events) {
  for (const event of events) if (event.kind !== "vanished") state.regionNames.set(event.region_id, event.display_name);
  const said = {
    appeared: ({ display_name: name, other }) => `${name} appeared${other ? ` (was ${nameOf(other)})` : ""}`,
    vanished: ({ display_name: name, other }) => `${name} is gone${other ? ` (now ${nameOf(other)})` : ""}`,
    retyped: ({ display_name: name, region_id: id }) => `${id} is now called ${name}`,
    reshaped: ({ display_name: name }) => `${name} has another shape`,
  };
  const words = events.map((event) => said[event.kind](event));
  byId("changes").textContent = words.slice(0, MOST_CHANGES).join("; ") + (words.length > MOST_CHANGES ? `; ${words.length - MOST_CHANGES} more` : "");
  byId("changes").title = words.join("; ");
  byId("changes").hidden = !words.length;
}

function showCells() {
  if (!state.cells) return;
  const style = getComputedStyle(document.documentElement);
  const wall = rgba(style.getPropertyValue("--wall"), 255);
  const thing = rgba(style.getPropertyValue("--ink"), 26);
  const { grid, image } = state.cells;
  const here = state.regions.filter((region) => region.floor === grid.floor);
  plan.setCells(grid, paintCells(image, grid, here, { wall, thing }));
}

function showFacts() {
  const facts = [
    [state.objects.size, "objects"], [state.regions.length, "regions"], [state.frames.length, "frames"], [state.version, "map version"],
  ];
  byId("facts").replaceChildren(...facts.map(([value, name]) => el("div", {}, el("dt", { text: name }), el("dd", { "data-testid": `fact-${name.replace(" ", "-")}`, text: value.toLocaleString("en") }))));
}

function showExports() {
  const base = `v1/scenes/${state.scene}`;
  const items = [
    ["Point cloud", "PLY, binary", `${base}/exports/ply`, {}],
    ["Point cloud", "PLY, text", `${base}/exports/ply`, { format: "ascii" }],
    ["Scene graph", "JSON: floors, regions, objects", `${base}/exports/scene-graph.json`, {}],
    ["Regions", "JSON: polygons in metres", `${base}/exports/regions.json`, {}],
    ["Maps for nav2", "zip: PGM and YAML of each floor", `${base}/exports/nav2`, {}],
    ["Floor plan", "PNG, all floors", `${base}/floorplan.png`, {}],
    ["This floor's plan", "PNG", `${base}/floorplan.png`, { floor: state.floor }],
  ];
  byId("exports").replaceChildren(...items.map(([name, what, path, params]) => el("li", {}, el("a", { href: link(path, params), download: "" }, name, el("small", { text: what })))));
}

async function showSystem() {
  try {
    const { services, vlm } = await getJson("v1/status");
    const away = Object.entries(services).filter(([, there]) => !there).map(([name]) => name);
    byId("foot").textContent = away.length
      ? `Not reachable: ${away.join(", ")}.`
      : vlm?.configured ? `VLM: ${vlm.routes.join(", ")}.` : "No VLM configured: built-in fallbacks judge.";
  } catch {
    byId("foot").textContent = "";
  }
}

function suggest(objects) {
  const counts = new Map();
  for (const obj of objects) counts.set(obj.label, (counts.get(obj.label) ?? 0) + obj.observations);
  const labels = [...counts].sort((a, b) => b[1] - a[1]).slice(0, SUGGESTED).map(([label]) => label);
  byId("suggestions").replaceChildren(...labels.map((label) => el("button", { type: "button", text: label, onclick: () => {
    byId("question").value = label;
    find(label);
  } })));
}

function describe(obj) {
  const [width, depth, height] = extents(obj.box).map((side) => metres(side).replace(" m", ""));
  const region = state.regionOf.get(obj.id)?.display_name;
  return [region, `${width} × ${depth} × ${height} m`, `seen in ${plural(obj.frames, "frame")}`].filter(Boolean).join(" · ");
}

function show(tab) {
  for (const name of ["answer", "objects", "regions"]) {
    byId(`tab-${name}`).setAttribute("aria-selected", String(name === tab));
    byId(`tab-${name}`).tabIndex = name === tab ? 0 : -1;
    byId(`panel-${name}`).hidden = name !== tab;
  }
}

function live(connection) {
  const words = { on: "live", wait: "reconnecting …", off: "not connected" };
  byId("live").dataset.state = connection;
  byId("live").textContent = words[connection];
  clearTimeout(state.silence);
  if (connection === "on") notice("");
  if (connection === "wait") state.silence = setTimeout(() => notice("The api service does not answer. Trying again …"), 2000);
  if (connection === "off") setTimeout(() => attempt(start), 3000);
}

/** Runs `work`; what goes wrong is said in words, and tried again where that may help. */
async function attempt(work) {
  try {
    await work();
    if (byId("notice").dataset.kind === "problem" && byId("live").dataset.state === "on") notice("");
  } catch (problem) {
    if (!(problem instanceof Problem)) throw problem;
    if (problem.status === 401) askForKey();
    else notice(problem.message, "problem");
    if (work === start && problem.status !== 401) setTimeout(() => attempt(start), 3000);
  }
}

function notice(text, kind = "problem") {
  byId("notice").textContent = text;
  byId("notice").dataset.kind = kind;
  byId("notice").hidden = !text;
}

function askForKey() {
  state.stop();
  byId("live").dataset.state = "off";
  byId("live").textContent = "key needed";
  if (!byId("key-dialog").open) byId("key-dialog").showModal();
}

function wire() {
  byId("ask").addEventListener("submit", (event) => {
    event.preventDefault();
    const text = byId("question").value.trim();
    if (text && state.scene) find(text);
  });
  byId("scene").addEventListener("change", () => {
    state.wanted = byId("scene").value;
    const address = new URL(location.href);
    address.searchParams.set("scene", state.wanted);
    history.replaceState(null, "", address);
    attempt(() => open(state.wanted));
  });
  setInterval(() => attempt(lookForScenes), SCENES_EVERY_MS);
  byId("floor").addEventListener("change", () => changeFloor(Number(byId("floor").value)));
  byId("paint").addEventListener("change", () => space.setPaint(byId("paint").value));
  byId("filter").addEventListener("input", () => showObjects());
  byId("key-form").addEventListener("submit", () => {
    setKey(byId("key").value);
    byId("key-why").textContent = "That key was not the right one. It is the value of OVIP_API_KEY.";
    attempt(start);
  });
  for (const button of document.querySelectorAll("[data-plan]")) {
    button.addEventListener("click", () => {
      ({ in: () => plan.zoom(1.4), out: () => plan.zoom(1 / 1.4), fit: () => plan.fit() })[button.dataset.plan]();
    });
  }
  document.querySelector("[data-space]").addEventListener("click", () => space.fit());
  for (const button of document.querySelectorAll("button[data-layout]")) {
    button.addEventListener("click", () => {
      const alone = byId("stage").dataset.layout === button.dataset.layout;
      byId("stage").dataset.layout = alone ? "both" : button.dataset.layout;
      button.setAttribute("aria-pressed", String(!alone));
    });
  }
  const tabs = ["answer", "objects", "regions"];
  for (const name of tabs) {
    byId(`tab-${name}`).addEventListener("click", () => show(name));
    byId(`tab-${name}`).addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      const next = tabs[(tabs.indexOf(name) + step + tabs.length) % tabs.length];
      show(next);
      byId(`tab-${next}`).focus();
    });
  }
  document.addEventListener("keydown", (event) => {
    if (event.key === "/" && !/^(INPUT|SELECT|TEXTAREA)$/.test(document.activeElement.tagName)) {
      event.preventDefault();
      byId("question").focus();
    }
    if (event.key === "Escape") byId("export").open = false;
  });
  document.addEventListener("click", (event) => {
    if (!byId("export").contains(event.target)) byId("export").open = false;
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    showCells();
    space.restyle();
  });
}

function rgba(color, alpha) {
  const hex = color.trim();
  return [...[1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16)), alpha];
}
