// Images of both cameras as they are read, and what is drawn on those of camera 1.
import { MapPanel } from "./map.js";
import { fitToWindow, showCameras } from "./cameras.js";
import { byId, circle, element, latest, report, showKey } from "./draw.js";
import { percent } from "./news.js";
import { get, post } from "./server.js";

const TOGGLE = 600; // time for which each camera is shown, in milliseconds
const WHOLE = [0, 0, 65536, 65536]; // of an image whose size is not known yet

// points that a tool needs, its hint, and what a drag does
const TOOLS = {
  move: { points: 0, drag: "move",
    hint: "Drag moves the image, the wheel zooms, a double click shows it whole." },
  scale: { points: 2, drag: "line", ask: "Distance [mm]",
    hint: "Click or drag from one mark of known distance to the other, and type the distance." },
  origin: { points: 1, drag: "move",
    hint: "Click where the profile has x = 0. It is drawn over the image: a line with the film above." },
  roi: { points: 2, drag: "region", hint: "Drag the region of the statistics, or click two corners." },
  patch: { points: 2, drag: "region", ask: "Film there [µm]",
    hint: "Drag a patch whose film is known, or click two corners, and type its film." },
  polygon: { points: 3, drag: "move", apply: true,
    hint: "Click the corners of a part that counts nowhere, as a scratch or a bolt; then apply." },
  brush: { points: 1, drag: "line", apply: true,
    hint: "Drag over parts that count nowhere; then apply." },
};
const IN_MM = ["roi", "patch", "polygon"]; // tools that need the scale

let [name, file, changed] = ["", null, null];
let tool = "move";
let points = []; // x and y in mm, of the tool that is used
let strokes = []; // of the brush: lists of points
let brushing = false; // since the pointer is down
let hover = null; // under the pointer, for the profile
let flickering = 0; // camera that the first panel shows while it flickers, 0 where it does not
const films = [null, null];
const states = [0, 1].map(() => ({ window: WHOLE, limits: {}, tool: "move", mark: null }));
let panels = [];

// `receive` gets the state after a change
export function makeFrames(about, receive) {
  changed = receive;
  panels = [1, 2].map((n) => new MapPanel(byId(`panel-${n}`), {
    about, state: states[n - 1], clicks: true,
    film: () => films[n - 1] ?? { x: [0, 1], y: [0, 1], width: WHOLE[2], height: WHOLE[3],
      labels: ["", ""] },
    layer: () => `camera${cameraOf(n)}`,
    load: async (view) => (await get("frame", { ...query(), camera: cameraOf(n), ...view }))
      .arrayBuffer(),
    shown: (found) => {
      fit(n - 1, found);
      if (n === 1) showKey(about.flags, about.flags.map(({ name: flag }, k) =>
        found.shares[k] && `${flag}: ${percent(found.shares[k])}`));
    },
    over: (stroke, at, pen) => n === 1 && drawShapes(stroke, at, pen),
    pressed: () => {
      brushing = false;
    },
    clicked: (place) => n === 1 && addPoint(place),
    drawn: (phase) => n === 1 && dragged(phase),
    pointed: (place) => n === 1 && pointed(place),
  }));
  connect();
}

const cameraOf = (n) => (n === 1 && flickering ? flickering : n);
const query = () => ({ name, purpose: byId("purpose").value, number: byId("number").value });

// the size of an image is known once it is there
function fit(n, found) {
  const pitch = file.pitch ?? 1;
  const unit = file.pitch ? "mm" : "px";
  const before = films[n];
  if (n === 0) [document.body.dataset.columns, document.body.dataset.rows] = [found.width, found.height];
  films[n] = { x: [0, pitch], y: [0, pitch], width: found.width, height: found.height,
    labels: [`x [${unit}]`, `y [${unit}]`] };
  if (before?.width === found.width && before?.height === found.height) return;
  states[n].window = [0, 0, found.width, found.height];
  states[n].limits = {};
  panels[n].refresh().catch(() => {});
}

// shows "run" or "fixture" with its settings
export function showFrames(given, about) {
  const other = name !== given || file?.pitch !== about.pitch;
  [name, file] = [given, about];
  if (other) {
    [points, strokes, states[0].mark] = [[], [], null];
    films.fill(null);
  }
  byId("refusal").textContent = about.refusal;
  const purposes = Object.keys(about.images);
  if (`${[...byId("purpose").options].map((option) => option.value)}` !== `${purposes}`) {
    byId("purpose").replaceChildren(...purposes.map((purpose) => element("option", purpose)));
  }
  const orientation = about.fields.find((field) => field.place === "registration.orientation");
  byId("orientation").replaceChildren(...orientation.choices.map((one) => element("option", one)));
  byId("orientation").value = orientation.value || "normal";
  for (const input of document.querySelectorAll("input[name=tool]")) {
    const { value } = input;
    input.disabled = (value === "origin" && name === "run") || (value === "patch" && name !== "run")
      || (IN_MM.includes(value) && !about.pitch);
    if (input.disabled && value === tool) choose("move");
  }
  limitNumber();
  showTool();
  load();
}

function limitNumber() {
  const most = Math.max(...(file.images[byId("purpose").value] ?? [1]));
  byId("number").max = most - 1; // a number beyond it becomes the last one
}

const load = latest(async () => {
  if (file.refusal) return;
  try {
    await Promise.all(panels.map((panel) => panel.refresh()));
    const { cameras } = await (await get("levels", query())).json();
    showCameras(cameras);
    report("");
  } catch (error) {
    report(error.message, true);
  }
});

// tools

function choose(next) {
  tool = next;
  document.querySelector(`input[name=tool][value=${tool}]`).checked = true;
  states[0].tool = TOOLS[tool].drag;
  panels[0].canvas.classList.toggle("draws", tool !== "move");
  clear();
}

function clear() {
  [points, strokes, hover] = [[], [], null];
  [states[0].line, states[0].region, states[0].mark] = [null, null, null];
  showTool();
}

function showTool() {
  const { points: needed, ask, apply, hint } = TOOLS[tool];
  const ready = (tool === "brush" ? strokes : points).length >= needed;
  byId("hint").textContent = file && !file.pitch && tool === "move"
    ? `${hint} Region, patch and polygon need the scale first.` : hint;
  byId("distance-label").hidden = byId("distance").disabled = !ask || !ready;
  byId("distance-label").firstChild.textContent = `${ask} `;
  byId("width-label").hidden = tool !== "brush";
  byId("apply").hidden = !(ask || apply) || !ready;
  byId("again").hidden = !points.length && !strokes.length;
  if (ask && ready) byId("distance").focus();
  panels[0].draw();
}

function addPoint({ x, y }) {
  const { points: needed, ask, apply } = TOOLS[tool];
  if (tool === "move") return;
  if (tool === "brush") strokes.push([[x, y]]);
  else if (points.length >= needed && !apply) points = [[x, y]];
  else points.push([x, y]);
  showTool();
  if (!ask && !apply && points.length === needed) finish();
}

function dragged(phase) {
  const { line, region } = states[0];
  if (tool === "brush") {
    if (!brushing) strokes.push([[line[0], line[1]]]);
    strokes.at(-1).push([line[2], line[3]]);
    states[0].line = null;
    brushing = true;
  } else points = line ? [line.slice(0, 2), line.slice(2)]
    : [[region[0], region[2]], [region[1], region[3]]];
  [states[0].line, states[0].region] = [null, null];
  if (phase === "going") panels[0].draw();
  else {
    showTool();
    if (!TOOLS[tool].ask && !TOOLS[tool].apply) finish();
  }
}

function pointed(place) {
  if (tool !== "origin") return;
  hover = place && [place.x, place.y];
  panels[0].draw();
}

// a position in mm to a tenth of a pixel
const rounded = (value) => +value.toFixed(Math.max(2, Math.ceil(1 - Math.log10(file.pitch))));
const interval = (axis) => points.map((point) => rounded(point[axis])).sort((a, b) => a - b);
const inPixels = (value) => value / (file.pitch ?? 1);

function valuesOf() {
  const asked = byId("distance").valueAsNumber;
  const region = () => ({ x: interval(0), y: interval(1) });
  switch (tool) {
    case "scale": {
      const [[x0, y0], [x1, y1]] = points;
      const pixels = inPixels(Math.hypot(x1 - x0, y1 - y0));
      return { "optics.pixel_pitch": `${+((1000 * asked) / pixels).toPrecision(4)} um` };
    }
    case "origin":
      return { "fixture.origin": points[0].map((value) => +inPixels(value).toFixed(1)) };
    case "roi": return { "thickness.roi": region() };
    case "patch":
      return { "reference.region": region(), "reference.thickness": `${asked} um` };
    default:
      return { "thickness.exclude": [...file.shapes.exclude,
        points.map((point) => point.map(rounded))] };
  }
}

// sends a change; a refusal leaves what is drawn
async function send(action, values) {
  try {
    const state = await post(action, { name, ...values });
    clear();
    changed(state);
  } catch (error) {
    report(error.message, true);
  }
}

function finish() {
  if (tool !== "brush") return send("change", { values: valuesOf() });
  const ways = strokes.map((stroke) =>
    stroke.map((point) => point.map((value) => Math.round(inPixels(value)))));
  return send("brush", { strokes: ways, width: byId("width").valueAsNumber });
}

// shapes of the settings, and those that are being drawn

function drawShapes(stroke, at, pen) {
  const { roi, patch, origin } = file.shapes;
  const outline = (corners, closed = true) => corners.length && stroke(() => {
    pen.moveTo(...at(...corners[0]));
    corners.slice(1).forEach((corner) => pen.lineTo(...at(...corner)));
    if (closed) pen.closePath();
  });
  const frame = ({ x, y }) => [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
  if (file.pitch) {
    for (const [region, text] of [[roi, "region"], [patch, "patch"]]) {
      if (!region) continue;
      outline(frame(region));
      label(pen, text, at(region.x[0], region.y[0]));
    }
    const place = hover ?? origin?.map((value) => value * file.pitch);
    if (place && films[0] && file.shapes.profile) drawProfile(place, outline, at, pen);
  }
  strokes.forEach((path) => outline(path, false));
  if (points.length) outline(points.length === 2 && ["roi", "patch"].includes(tool)
    ? frame({ x: interval(0), y: interval(1) }) : points, tool === "polygon");
  points.forEach((point) => circle(pen, at(...point), 3));
}

function label(pen, text, [x, y]) {
  pen.font = '12px system-ui, "DejaVu Sans", sans-serif';
  [pen.textAlign, pen.textBaseline] = ["left", "top"];
  [pen.lineWidth, pen.strokeStyle, pen.fillStyle] = [3, "#ffffff", "#000000"];
  pen.strokeText(text, x + 5, y + 4);
  pen.fillText(text, x + 5, y + 4);
}

// the line of a profile with its film above it, or the points of a surface
function drawProfile([x, y], outline, at, pen) {
  const { profile, thickness, direction } = file.shapes;
  const [cos, sin] = [Math.cos(direction), Math.sin(direction)];
  const placed = (a, b) => [x + cos * a - sin * b, y + sin * a + cos * b];
  if (Array.isArray(profile[0])) {
    profile.forEach((point) => circle(pen, at(...placed(...point)), 3));
    return;
  }
  const tall = (0.3 * films[0].height * file.pitch) / Math.max(...thickness);
  outline(profile.map((a) => placed(a, 0)), false);
  outline(profile.map((a, n) => placed(a, -tall * thickness[n])), false);
  circle(pen, at(x, y), 3);
  label(pen, "x = 0 of the profile", at(x, y));
}

function connect() {
  byId("number").addEventListener("input", load);
  byId("purpose").addEventListener("change", () => {
    limitNumber();
    load();
  });
  byId("orientation").addEventListener("change", () => {
    const { value } = byId("orientation");
    send("change", { values: { "registration.orientation": value === "normal" ? "" : value } });
  });
  byId("flicker").addEventListener("change", () => {
    flickering = +byId("flicker").checked;
    panels[0].refresh().catch(() => {});
  });
  setInterval(() => {
    if (!flickering) return;
    flickering = 3 - flickering;
    panels[0].refresh().catch(() => {});
  }, TOGGLE);
  for (const input of document.querySelectorAll("input[name=tool]")) {
    input.addEventListener("change", () => choose(input.value));
  }
  byId("act").addEventListener("submit", (event) => {
    event.preventDefault();
    finish();
  });
  byId("again").addEventListener("click", clear);
  panels[0].canvas.addEventListener("keydown", pressed);
  fitToWindow(panels);
  choose("move");
}

// arrows move a cursor by pixels, with Shift by ten; Enter sets a point there
function pressed(event) {
  const film = films[0];
  const across = { ArrowLeft: -1, ArrowRight: 1 }[event.key] ?? 0;
  const down = { ArrowUp: -1, ArrowDown: 1 }[event.key] ?? 0;
  if (!film || tool === "move" || (!across && !down && event.key !== "Enter")) return;
  event.preventDefault();
  const many = event.shiftKey ? 10 : 1;
  const [x, y] = states[0].mark ?? [film.width / 2, film.height / 2].map((half) =>
    Math.round(half) * film.x[1]);
  states[0].mark = [x + across * many * film.x[1], y + down * many * film.y[1]];
  if (event.key === "Enter") addPoint({ x, y });
  hover = tool === "origin" ? states[0].mark : null;
  panels[0].draw();
}
