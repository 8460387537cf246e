// The answer panel: tiers as they run, then the verdict with its evidence, candidates, coverage and fallbacks.

import { el } from "./dom.js";
import { metres, millis, pathLength, percent, placeInWords, plural, position } from "./format.js";

const TIERS = { 1: "Map lookup", 2: "Tags of the frames", 3: "Second look at frames", 4: "Active search" };
const RESULTS = {
  running: "running …", found: "found", ambiguous: "several", missing: "nothing", rejected: "rejected", skipped: "skipped",
  waiting: "needs a robot", exhausted: "all seen",
};

export class AnswerPanel {
  constructor(root, on) {
    this.root = root;
    this.on = on;
    this.idle();
  }

  idle() {
    this.root.replaceChildren(el("p", { class: "quiet", text: "Ask where something is. The search goes from cheap to costly: the map, the tags of the frames, a second look at the frames, and last a robot that drives there." }));
  }

  /** A question was sent. */
  begin(text) {
    this.text = text;
    this.began = performance.now();
    this.head = el("div", { "data-testid": "answer" }, el("h3", { class: "verdict", "data-outcome": "running", "data-testid": "answer-outcome", text: `Looking for ${text} …` }));
    this.tiers = el("ol", { class: "tiers", "data-testid": "tier-list" });
    this.tail = el("div");
    this.root.replaceChildren(this.head, this.tiers, this.tail);
  }

  tierStarted(number) {
    this.tierNode(number).replaceWith(this.tierRow({ tier: number, result: "running", why: "", vlm_calls: 0, ms: null }));
  }

  tierFinished(report) {
    this.tierNode(report.tier).replaceWith(this.tierRow(report));
  }

  /** The answer: {objects, regionOf} let it say where the thing is. */
  finish(answer, scene) {
    for (const report of answer.tiers) this.tierFinished(report);
    for (const node of this.tiers.querySelectorAll('[data-result="running"]')) node.remove();
    this.head.replaceChildren(this.verdict(answer), ...this.place(answer, scene));
    this.tail.replaceChildren(
      ...this.evidence(answer),
      ...this.needs(answer),
      ...this.candidates("Other candidates", answer.candidates.filter((c) => !c.id || c.id !== answer.object?.id), "candidate"),
      ...this.coverage(answer.coverage),
      ...this.candidates("Looked at and rejected", answer.rejected, "rejected"),
      ...this.fallbacks(answer.fallbacks),
    );
    this.tail.append(el("p", { class: "quiet", text: `Map version ${answer.map_version}, regions ${answer.regions_revision}.` }));
  }

  fail(problem) {
    this.head ?? this.begin(this.text ?? "");
    for (const node of this.tiers.querySelectorAll('[data-result="running"]')) node.remove();
    this.head.replaceChildren(
      el("h3", { class: "verdict", "data-outcome": "problem", "data-testid": "answer-outcome", text: "The search could not be made" }),
      el("p", { class: "where-line", "data-testid": "answer-problem", text: problem.message }));
  }

  verdict(answer) {
    const label = answer.object?.label ?? this.text;
    const words = {
      found: `Found ${withArticle(label)} in tier ${answer.tier}`,
      absent: `There is no ${this.text} here`,
      unresolved: `No ${this.text} found so far`,
    };
    return el("h3", { class: "verdict", "data-outcome": answer.outcome, "data-tier": answer.tier, "data-testid": "answer-outcome", text: words[answer.outcome] });
  }

  place(answer, { objects, regionOf }) {
    const lines = [];
    if (answer.object) {
      const where = placeInWords(answer.object, objects, regionOf);
      const walk = answer.path.length > 1 ? `${metres(pathLength(answer.path))} to walk from the robot` : "";
      const words = [where, walk].filter(Boolean).join("; ");
      lines.push(el("p", { class: "where-line" },
        words ? `${words[0].toUpperCase()}${words.slice(1)}. ` : "",
        el("span", { class: "mono", "data-testid": "answer-position", title: "x, y, z in metres, z up", text: `at ${position(answer.object.position)} m` })));
    }
    if (answer.coverage && answer.outcome !== "found") {
      const { planned, visited, unreachable, posterior_present: left, complete } = answer.coverage;
      const blocked = unreachable ? `, ${unreachable} out of reach` : "";
      lines.push(el("p", { class: "where-line", "data-testid": "answer-coverage",
        text: `${visited} of ${plural(planned, "viewpoint")} visited${blocked}${complete ? ", coverage complete" : ""}. The chance that it is here after all: ${percent(left ?? 0)}.` }));
    }
    return lines;
  }

  evidence(answer) {
    const shown = answer.object;
    if (!shown?.frame_id) return [];
    const canvas = el("canvas", { width: 680, height: 360, "data-testid": "evidence", role: "img", "aria-label": `${shown.label} in frame ${shown.frame_id}` });
    const caption = el("figcaption", { text: `Best seen in frame ${shown.frame_id}` });
    this.on.image(shown.frame_id)
      .then((image) => {
        drawCrop(canvas, image, shown.box2);
        canvas.dataset.drawn = "true";
      })
      .catch((problem) => {
        canvas.hidden = true;
        caption.textContent = `Best seen in frame ${shown.frame_id}, whose image cannot be shown: ${problem.message}`;
      });
    return [el("figure", { class: "evidence" }, canvas, caption)];
  }

  needs(answer) {
    if (!answer.needs) return [];
    return [el("div", { class: "needs", "data-testid": "answer-needs" }, el("b", { text: "What would decide it" }), answer.needs)];
  }

  candidates(title, items, testid) {
    if (!items.length) return [];
    const rows = items.slice(0, 12).map((item, index) => el("li", {}, el("button", {
      class: "row", type: "button", "data-testid": testid, onclick: () => this.on.pick(item.id, item),
    },
      el("span", { class: "side-note", text: String(index + 1) }),
      el("span", {}, el("span", { class: "name", text: item.label }), el("br"), el("span", { class: "where", text: item.why })),
      el("span", { class: "side-note", text: item.score === null ? "" : item.score.toFixed(2) }))));
    const list = el("ul", { class: "rows" }, rows);
    if (testid === "rejected") return [el("details", { class: "more" }, el("summary", { text: `${title} (${items.length})` }), list)];
    return [el("h4", { class: "block", text: title }), list];
  }

  coverage(coverage) {
    if (!coverage?.regions.length) return [];
    const rows = [...coverage.regions].sort((a, b) => (b.prior ?? 0) - (a.prior ?? 0)).map((region) => el("tr", {},
      el("td", { text: region.display_name }),
      el("td", {}, el("meter", { min: 0, max: 1, value: region.prior ?? 0, title: percent(region.prior ?? 0) })),
      el("td", { text: percent(region.seen ?? 0) })));
    return [el("h4", { class: "block", text: "Where it would be looked for" }), el("table", { class: "coverage", "data-testid": "coverage" },
      el("tr", {}, el("th", { text: "Region" }), el("th", { text: "Likely" }), el("th", { text: "Seen" })), rows)];
  }

  fallbacks(items) {
    if (!items.length) return [];
    return [el("h4", { class: "block", text: "Without a VLM" }), el("ul", { class: "fallbacks", "data-testid": "fallbacks" }, items.map((text) => el("li", { text })))];
  }

  tierNode(number) {
    const held = this.tiers.querySelector(`[data-tier="${number}"]`);
    if (held) return held;
    const fresh = el("li", { "data-tier": number });
    this.tiers.append(fresh);
    return fresh;
  }

  tierRow({ tier, result, why, vlm_calls: calls, ms }) {
    const cost = ms === null ? "" : ` · ${millis(ms)}${calls ? ` · ${plural(calls, "VLM call")}` : ""}`;
    return el("li", { class: "tier", "data-tier": tier, "data-result": result, "data-testid": `tier-${tier}` },
      el("span", { class: "number", text: String(tier) }),
      el("span", { class: "title", text: TIERS[tier] ?? `Tier ${tier}` }),
      el("span", { class: "result", text: `${RESULTS[result] ?? result}${cost}` }),
      why ? el("span", { class: "why", text: why }) : null);
  }
}

/** Draws what is around `box2` (all of the frame where there is none), and the box itself. */
function drawCrop(canvas, image, box2) {
  const context = canvas.getContext("2d");
  const [x0, y0, x1, y1] = box2 ?? [0, 0, image.width, image.height];
  const ratio = canvas.width / canvas.height;
  const spread = box2 ? 2.4 : 1;
  let height = Math.max((y1 - y0) * spread, ((x1 - x0) * spread) / ratio, 0.3 * image.height);
  height = Math.min(height, image.height, image.width / ratio);
  const width = height * ratio;
  const left = Math.min(Math.max((x0 + x1 - width) / 2, 0), image.width - width);
  const top = Math.min(Math.max((y0 + y1 - height) / 2, 0), image.height - height);
  context.drawImage(image, left, top, width, height, 0, 0, canvas.width, canvas.height);
  if (!box2) return;
  const scale = canvas.width / width;
  const edge = [(x0 - left) * scale, (y0 - top) * scale, (x1 - x0) * scale, (y1 - y0) * scale];
  for (const [color, line] of [["rgb(255 255 255 / 85%)", 7], ["#0f9c89", 3.5]]) {
    context.strokeStyle = color;
    context.lineWidth = line;
    context.strokeRect(...edge);
  }
}

const withArticle = (label) => (/s$/.test(label) ? label : `the ${label}`);
