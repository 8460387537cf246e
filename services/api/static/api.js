// Talks to the REST interface: JSON, bytes, streamed answers, live events. Carries the key.

const KEY = "ovip-key";

/** What went wrong, in words. status 0: nobody answered. */
export class Problem extends Error {
  constructor(status, detail, slug = "") {
    super(detail);
    this.status = status;
    this.slug = slug;
  }
}

/** Takes the key from `?key=` into this tab's session and out of the address bar. */
export function adoptKey() {
  const address = new URL(location.href);
  const key = address.searchParams.get("key");
  if (key === null) return;
  setKey(key);
  address.searchParams.delete("key");
  history.replaceState(null, "", address);
}

export function setKey(key) {
  sessionStorage.setItem(KEY, key);
}

/** A link that a browser can open by itself: with the key in it. */
export function link(path, params = {}) {
  const url = new URL(path.replace(/^\//, ""), new URL(".", location.href));
  for (const [name, value] of Object.entries(params)) url.searchParams.set(name, value);
  const key = sessionStorage.getItem(KEY);
  if (key) url.searchParams.set("key", key);
  return url.href;
}

export async function getJson(path, params) {
  return (await request(path, params)).json();
}

export async function getBytes(path, params) {
  return (await request(path, params)).arrayBuffer();
}

export async function getImage(path) {
  return createImageBitmap(await (await request(path)).blob());
}

/** Events of a search as they happen: [name, body]. */
export async function* ask(scene, question, signal) {
  const response = await request(`v1/scenes/${scene}/queries`, {}, {
    method: "POST",
    headers: { "Content-Type": "application/json", Accept: "text/event-stream" },
    body: JSON.stringify(question),
    signal,
  });
  const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      text += value;
      const blocks = text.split("\n\n");
      text = blocks.pop();
      for (const block of blocks) {
        const event = parseEvent(block);
        if (event) yield event;
      }
    }
  } finally {
    reader.cancel().catch(() => {});
  }
}

/** Live changes of a scene after a map version. Returns a function that stops. */
export function follow(scene, after, on) {
  const source = new EventSource(link(`v1/scenes/${scene}/events`, { after }));
  source.onopen = () => on.state("on");
  source.onerror = () => on.state(source.readyState === EventSource.CLOSED ? "off" : "wait");
  source.addEventListener("map", (event) => on.map(JSON.parse(event.data)));
  source.addEventListener("regions", (event) => on.regions(JSON.parse(event.data)));
  return () => source.close();
}

async function request(path, params = {}, options = {}) {
  const url = new URL(path.replace(/^\//, ""), new URL(".", location.href));
  for (const [name, value] of Object.entries(params)) url.searchParams.set(name, value);
  const key = sessionStorage.getItem(KEY);
  const headers = { ...(key ? { Authorization: `Bearer ${key}` } : {}), ...(options.headers ?? {}) };
  let response;
  try {
    response = await fetch(url, { ...options, headers });
  } catch (error) {
    if (error.name === "AbortError") throw error;
    throw new Problem(0, "The api service does not answer. Is the stack running?");
  }
  if (response.ok) return response;
  const problem = await response.json().catch(() => ({}));
  throw new Problem(response.status, problem.detail ?? `The api service answered ${response.status}.`, problem.type ?? "");
}

function parseEvent(block) {
  let name = "message";
  const data = [];
  for (const line of block.split("\n")) {
    if (line.startsWith("event: ")) name = line.slice(7);
    else if (line.startsWith("data: ")) data.push(line.slice(6));
  }
  return data.length ? [name, JSON.parse(data.join("\n"))] : null;
}
