// Making elements: HTML and SVG.

const SVG = "http://www.w3.org/2000/svg";

/** An HTML element with properties (data- and aria- names become attributes) and children. */
export function el(tag, props = {}, ...children) {
  return fill(document.createElement(tag), props, children);
}

/** An SVG element. */
export function svg(tag, props = {}, ...children) {
  return fill(document.createElementNS(SVG, tag), props, children);
}

/** The element with this id. */
export const byId = (id) => document.getElementById(id);

function fill(node, props, children) {
  for (const [name, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "text") node.textContent = value;
    else node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/**
 * Runs `work` within `wait` ms of being asked, however often it is asked meanwhile, and never twice at once; what is asked
 * while it runs makes it run again. So a steady stream of requests gives a steady beat and the last one is never lost.
 */
export function paced(work, wait) {
  let pending = false;
  let running = false;
  const beat = () => setTimeout(async () => {
    pending = false;
    running = true;
    try {
      await work();
    } finally {
      running = false;
      if (pending) beat();
    }
  }, wait);
  return () => {
    if (pending) return;
    pending = true;
    if (!running) beat();
  };
}
