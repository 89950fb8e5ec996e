// The page of `erlif view`: controls, maps and charts. Values come from the server of the same
// address, within a report from the report itself; nothing is loaded from anywhere else.
import { MapPanel } from "./map.js";
import { CycleChart, ProfileChart } from "./charts.js";
import { byId, element, latest, report, showKey } from "./draw.js";
import { ask } from "./server.js";

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

const state = {
  a: { film: 0, trigger: 0 },
  b: { film: 0, trigger: 0 },
  two: false,
  linked: false,
  layer: "thickness",
  unit: "difference",
  limits: {}, // colour limits of a layer, once known
  fitted: {}, // panels whose map the limits of a layer hold; null where the user gave them
  window: null, // visible part of the map, in pixels of the map: left, top, right, bottom
  tool: "move",
  line: null, // x0, y0, x1, y1 in mm
  width: 1, // of the line, in pixels of the map
  region: null, // x0, x1, y0, y1 in mm
  mark: null, // place on the line under the pointer of the profile, in mm
  playing: false,
};
let about = null; // films, layers, flags and palettes
const film = (which = "a") => about.films[state[which].film];

function guarded(action) {
  return async (...values) => {
    try {
      return await action(...values);
    } catch (error) {
      report(error.message, true);
      if (!(error instanceof Error)) throw error;
      stop();
    }
  };
}

// maps

const panels = {};

const mapQuery = (name) => (name === "d"
  ? { ...state.a, layer: state.unit, film2: state.b.film, trigger2: state.b.trigger }
  : { ...state[name], layer: stored() });

const stored = () => (state.layer === "flags" ? "thickness" : state.layer);
const layerOf = (panel) => (panel === "d" ? state.unit : state.layer);

function makePanels() {
  for (const name of ["a", "b", "d"]) {
    panels[name] = new MapPanel(byId(`panel-${name}`), {
      about, state, film: () => film("a"), layer: () => layerOf(name),
      load: async (view) => {
        const query = mapQuery(name);
        const slow = ["log_ratio", "camera1", "camera2"].includes(query.layer);
        if (slow) report("The images are computed from the frames …");
        const found = await ask.map({ ...query, ...view, coarse: state.playing ? 1 : 0 });
        if (slow) report("");
        return found;
      },
      shown: (found) => mapShown(name, found),
      drawn: (what) => drawn(what),
      moved: () => Object.values(panels).forEach((panel) => panel.refresh()),
      pointed: (place) => readPixel(place),
      clicked: (place) => chooseRow(place),
    });
  }
}

function mapShown(name, found) {
  const layer = layerOf(name);
  fitLimits(name, layer, found.limits.map((v) => +v.toPrecision(4)));
  if (name === "a") {
    showLimits();
    showKey(about.flags, about.flags.map(({ name: flag }, n) =>
      `${flag} ${describeShare(found.shares[n])}`));
    byId("trigger").setAttribute("aria-valuetext", found.text);
  }
}

// Both maps have one scale: that of the first map of each, and the same at all other triggers.
function fitLimits(name, layer, found) {
  const known = state.limits[layer];
  const fitted = state.fitted[layer] ?? [];
  if (known && (state.fitted[layer] === null || fitted.includes(name))) return;
  state.fitted[layer] = [...fitted, name];
  state.limits[layer] = !known ? found
    : [Math.min(known[0], found[0]), Math.max(known[1], found[1])];
  if (!known) return;
  showLimits();
  redraw(); // the map that was drawn first
}

function forgetLimits(...layers) {
  for (const layer of layers) {
    delete state.limits[layer];
    delete state.fitted[layer];
  }
}

function showLimits() {
  const [low, high] = state.limits[state.layer] ?? ["", ""];
  byId("low").value = low;
  byId("high").value = high;
}

const refreshMaps = guarded(async () => {
  const before = byId("status").textContent;
  await Promise.all(Object.values(panels).map((panel) => panel.refresh()));
  const bad = byId("status").classList.contains("bad");
  if (bad && byId("status").textContent === before) report(""); // the reason has gone
});

const redraw = () => Object.values(panels).forEach((panel) => panel.draw());

const describeShare = (share) => (share > 0 && share < 5e-5 ? "below 0.01 %"
  : `${(100 * share).toFixed(2)} %`);

// triggers

function setTrigger(trigger, which = "a") {
  state[which].trigger = clamp(Math.round(trigger) || 0, 0, lastOf(which));
  if (which === "a" && state.linked) state.b.trigger = partner(state.a.trigger);
  showTrigger();
  cycleChart?.mark();
  return refreshAll();
}

// Triggers are counted from 0; their numbers are those of the film, of which a report may have some.
const lastOf = (which) => film(which).numbers.length - 1;
const numberOf = (which) => film(which).numbers[state[which].trigger];

function showTrigger() {
  byId("trigger").value = state.a.trigger;
  byId("trigger-number").value = numberOf("a");
  byId("trigger-b").value = numberOf("b");
}

// Trigger of the second film that belongs to one of the first: the nearest crank angle, or the
// nearest encoder angle of the same stroke; the same number where the films have no such angle.
function partner(trigger) {
  const last = lastOf("b");
  const [one, two] = [cycles.get(state.a.film), cycles.get(state.b.film)];
  const name = pairedBy();
  const place = one?.columns[name]?.[trigger];
  if (state.a.film === state.b.film || name === "" || place === null || place === undefined) {
    return Math.min(trigger, last);
  }
  let [best, least] = [Math.min(trigger, last), Infinity];
  two.columns[name].forEach((other, n) => {
    if (other === null || two.stroke[n] !== one.stroke[trigger]) return;
    const apart = Math.abs(other - place);
    // angles of one mark scatter a little from turn to turn
    const off = Math.round(20 * (name === "crank_angle" ? Math.min(apart, 360 - apart) : apart));
    const nearer = off === least && Math.abs(n - trigger) < Math.abs(best - trigger);
    if (off < least || nearer) [best, least] = [n, off];
  });
  return best;
}

// The angle by which both films are paired.
function pairedBy() {
  const both = [cycles.get(state.a.film), cycles.get(state.b.film)];
  return ["crank_angle", "encoder_angle"].find((name) =>
    both.every((cycle) => cycle?.columns[name])) ?? "";
}

// A number that no trigger has is reported; the nearest trigger is shown.
async function typeTrigger(id, which) {
  const given = byId(id).value;
  const { numbers } = film(which);
  const after = numbers.findIndex((number) => number >= Number(given));
  const done = setTrigger(after < 0 ? numbers.length : after, which);
  const shown = numberOf(which); // while it is drawn another may be chosen
  await done;
  if (given !== `${shown}`) {
    report(`Expected a trigger from ${numbers[0]} to ${numbers.at(-1)}; got ${given || "none"}. `
      + `Trigger ${shown} is shown.`, true);
  }
}

async function refreshAll() {
  await refreshMaps(); // numbers follow, and delay neither maps nor messages
  if (!state.playing) refreshValues();
}
const stride = () => Math.max(1, Math.round(byId("stride").valueAsNumber) || 1);
const step = (change) => setTrigger(state.a.trigger + change);

async function play() {
  state.playing = !state.playing;
  showPlaying();
  while (state.playing) {
    const next = state.a.trigger + stride();
    const started = performance.now();
    await setTrigger(next <= lastOf("a") ? next : 0);
    await new Promise((r) => setTimeout(r, Math.max(0, 80 - (performance.now() - started))));
  }
  refreshAll(); // in full detail
}

function stop() {
  state.playing = false;
  showPlaying();
}

function showPlaying() {
  byId("play").textContent = state.playing ? "Stop" : "Play";
  byId("play").setAttribute("aria-pressed", state.playing);
}

// line, region and pixel

let profileChart = null;
let cycleChart = null;
let statistics = []; // of the region: title and numbers of each row

function drawn(what) {
  fillForms();
  redraw();
  if (what !== "going") refreshValues();
}

const which = () => (state.two ? ["a", "b"] : ["a"]);

const refreshValues = guarded(latest(async () => {
  if (state.line) {
    const line = { line: state.line.join(), width: state.width };
    const found = await Promise.all(which().map((name) =>
      ask.profile({ ...mapQuery(name), ...line })));
    profileChart.show(found, axisTitle(stored()));
  }
  if (state.region && ask.region) {
    const rows = which().map((name) => [name === "a" ? "first" : "second", mapQuery(name)]);
    if (state.two) rows.push(["second − first", mapQuery("d")]);
    statistics = await Promise.all(rows.map(async ([title, query]) =>
      [title, await ask.region({ ...query, region: state.region.join() })]));
    showStatistics(statistics);
    showMinimum();
  }
}));

function axisTitle(name) {
  const layer = about.layers.find((one) => one.name === name);
  return `${layer.title} [${layer.unit}]`;
}

function showStatistics(rows) {
  const digits = (value) => (value === null ? "–" : Number(value).toPrecision(4));
  const few = (value) => (value === null ? "–" : Number(value).toPrecision(2));
  const head = ["", "pixels", "valid", "mean", "± random", "± shared",
    ...(stored() === "thickness" ? ["thinnest pixel", "thickest pixel"]
      : ["lowest pixel", "highest pixel"]), "std"];
  const cells = rows.map(([title, one]) => [
    rows.length > 1 ? `${title} [${one.unit}]` : `[${one.unit}]`, one.count, one.valid,
    digits(one.mean), few(one.mean_std), few(one.mean_std_shared),
    ...[one.min, one.max, one.std].map(digits)]);
  byId("statistics").replaceChildren(...[head, ...cells].map((row, n) =>
    element("tr", ...row.map((text, k) => {
      const cell = element(n ? "td" : "th", text);
      if (!n) cell.scope = "col";
      if (n) cell.dataset.title = head[k];
      return cell;
    }))));
}

// The minimum of the run beside the thinnest pixel, which noise chooses.
function showMinimum() {
  const texts = which().map((name) => {
    const { film_min: value, film_min_std: std } = cycles.get(state[name].film)?.columns ?? {};
    const { trigger } = state[name];
    if ((value?.[trigger] ?? null) === null || (std?.[trigger] ?? null) === null) return "";
    return `trigger ${numberOf(name)}: film_min ${value[trigger].toFixed(3)} ± ${std[trigger].toFixed(3)} µm`;
  }).filter(Boolean);
  byId("minimum").textContent = texts.length && stored() === "thickness"
    ? `Minimum of the gap in the region of the run, ${texts.join("; ")}. `
      + "The thinnest pixel is that with the most noise." : "";
}

const readPixel = guarded(latest(async (place) => {
  if (!place) return;
  const found = await ask.pixel({ ...mapQuery("a"), place: `${place.x},${place.y}` });
  byId("readout").textContent = describePixel(found);
}));

function describePixel({ x, y, column, row, flags, unit, value, std, std_shared, predicted }) {
  const digits = (number, count = 4) =>
    `${number === null ? "–" : +number.toPrecision(count)}${unit === "1" ? "" : ` ${unit}`}`;
  const place = `x = ${x.toFixed(3)} mm, y = ${y.toFixed(3)} mm (column ${column}, row ${row})`;
  const names = about.flags.filter(({ bit }) => flags & bit).map(({ name }) => name);
  const errors = (std ?? null) === null ? ""
    : ` ± ${digits(std, 2)} random ± ${digits(std_shared, 2)} shared`;
  const theory = (predicted ?? null) === null ? "" : `; predicted ${digits(predicted)}`
    + (value === null ? "" : `, difference ${digits(value - predicted, 2)}`);
  return `${place}: ${flags ? `flagged, ${names.join(", ")}` : digits(value) + errors}${theory}`;
}

// The profile of the row that was clicked.
function chooseRow(place) {
  const { x, width } = film();
  state.line = [x[0], place.y, x[0] + x[1] * (width - 1), place.y];
  readPixel(place);
  drawn("line");
}

const WANTED = {
  line: "The line needs four numbers: x and y of both ends.",
  region: "The region needs four numbers: x and y, each from low to high.",
};
const FORMS = { line: ["x0", "y0", "x1", "y1"], region: ["x0", "x1", "y0", "y1"] };

function fillForms() {
  for (const [form, names] of Object.entries(FORMS)) {
    state[form]?.forEach((value, n) => {
      byId(`${form}-form`).elements[names[n]].value = +value.toFixed(4);
    });
  }
}

// the second map

// Maps share axes, line and region, so that both films must lie on one grid.
function matchGrids() {
  const [one, other] = [film("a"), film("b")].map(({ width, height, x, y }) =>
    [width, height, ...x, ...y]);
  if (one.every((value, n) => Math.abs(value - other[n]) <= 1e-6 * Math.abs(value))) return "";
  const name = film("b").name || film("b").file;
  state.b = { ...state.a };
  fillOther();
  return `${name} has another size or pitch of pixels. Open it in a viewer of its own.`;
}

function fillOther() {
  byId("film-b").value = state.b.film;
  byId("trigger-b").max = film("b").numbers.at(-1);
  byId("trigger-b").value = numberOf("b");
}

async function showTwo(yes) {
  const refused = yes ? matchGrids() : "";
  state.two = yes;
  document.body.classList.toggle("two", yes);
  for (const id of ["other", "panel-b", "panel-d"]) byId(id).hidden = !yes;
  fillExports();
  cycleChart?.build();
  profileChart.build(which().length);
  await refreshAll();
  if (refused) report(refused, true);
}

// export

const EXPORTS = {
  a: ["map", ["png", "csv", "tiff"]],
  b: ["second map", ["png", "csv", "tiff"]],
  d: ["difference", ["png", "csv", "tiff"]],
  profile: ["profile", ["png", "csv"]],
  region: ["statistics of the region", ["csv"]],
  cycle: ["film of all triggers", ["png", "csv"]],
};

function fillExports() {
  const before = byId("what").value;
  const names = Object.keys(EXPORTS).filter((name) => (state.two || !["b", "d"].includes(name))
    && (ask.region || name !== "region"));
  byId("what").replaceChildren(...names.map((name) => new Option(EXPORTS[name][0], name)));
  byId("what").value = names.includes(before) ? before : "a";
  allowExports();
}

function allowExports() {
  const what = byId("what").value;
  const kinds = what in panels && !ask.export ? ["png"] : EXPORTS[what][1];
  for (const kind of ["png", "csv", "tiff"]) byId(kind).disabled = !kinds.includes(kind);
}

function download(content, name) {
  const link = element("a");
  link.href = URL.createObjectURL(content);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

const exportData = guarded(async (kind) => {
  const what = byId("what").value;
  if (what in TABLES) {
    await refreshValues(); // those of the line and region as they are drawn now
    download(writeTable(TABLES[what]()), `${runOf("a")}_${what}.csv`);
    return;
  }
  // fetched first, so that a refusal is shown and not saved
  const query = { ...mapQuery(what), window: state.window.join(), kind };
  download(await ask.export(query), nameOf(what, query.layer, kind));
});

// Columns of what is exported as a table, by their headings.
const asciiUnit = (unit) => unit.replace("µ", "u");
const TABLES = {
  profile: () => {
    const [{ position, value, std, predicted }] = profileChart.found;
    const unit = asciiUnit(about.layers.find(({ name }) => name === stored()).unit);
    return { "position [mm]": position, [`value [${unit}]`]: value, [`std [${unit}]`]: std,
      ...(predicted ? { [`predicted [${unit}]`]: predicted } : {}) };
  },
  region: () => {
    const [, { unit, ...numbers }] = statistics[0];
    const ends = ["x_low [mm]", "x_high [mm]", "y_low [mm]", "y_high [mm]"];
    const values = { trigger: numberOf("a"), layer: stored(), unit: asciiUnit(unit),
      ...Object.fromEntries(ends.map((name, n) => [name, state.region[n]])), ...numbers };
    return Object.fromEntries(Object.entries(values).map(([name, value]) => [name, [value]]));
  },
  cycle: () => {
    const { stroke, columns, units } = cycles.get(state.a.film);
    return Object.fromEntries(Object.entries({ stroke, ...columns }).map(([name, values]) =>
      [`${name} [${units[name] ?? "1"}]`, values]));
  },
};

function writeTable(columns) {
  const rows = Object.values(columns)[0].map((_, n) =>
    Object.values(columns).map((values) => values[n] ?? "").join());
  return new Blob([[Object.keys(columns).join(), ...rows, ""].join("\n")], { type: "text/csv" });
}

const runOf = (which) =>
  (film(which).name || film(which).file).replace(/[^\p{L}\p{N}-]+/gu, "_");

function nameOf(what, layer, kind) {
  const shown = what === "b" ? "b" : "a";
  const trigger = what === "cycle" ? "" : `_${numberOf(shown)}`;
  return `${runOf(shown)}_${layer}${trigger}.${kind}`;
}

const exportPicture = guarded(async () => {
  const what = byId("what").value;
  if (what === "profile") await refreshValues();
  const source = what in panels ? panels[what].canvas
    : (what === "profile" ? profileChart : cycleChart).canvas();
  const caption = what in panels ? panels[what].caption() : byId("run").textContent;
  const page = document.createElement("canvas");
  const ratio = window.devicePixelRatio;
  const head = 26 * ratio;
  page.width = source.width;
  page.height = source.height + head;
  const pen = page.getContext("2d");
  pen.fillStyle = getComputedStyle(document.body).backgroundColor;
  pen.fillRect(0, 0, page.width, page.height);
  pen.drawImage(source, 0, head);
  pen.fillStyle = getComputedStyle(document.body).color;
  pen.font = `${13 * ratio}px system-ui, "DejaVu Sans", sans-serif`;
  pen.fillText(caption, 8 * ratio, 17 * ratio, page.width - 16 * ratio);
  const blob = await new Promise((r) => page.toBlob(r, "image/png"));
  download(blob, nameOf(what, what in panels ? layerOf(what) : what, "png"));
});

// region to run.toml

let proposal = null;

const proposeRegion = guarded(async () => {
  const values = { film: state.a.film, region: state.region };
  const found = await ask.settings(values);
  proposal = { ...values, before: found.before };
  byId("confirm-file").textContent = found.file;
  byId("confirm-change").textContent = found.change;
  byId("confirm").showModal();
});

const writeRegion = guarded(async () => {
  byId("confirm").close();
  const found = await ask.settings({ ...proposal, confirmed: true });
  report(`The region is in ${found.file}. erlif process uses it.`);
});

// start

function fillControls() {
  const titles = about.films.map((one, n) => `${n + 1}: ${one.name} (${one.file})`);
  for (const id of ["film-a", "film-b"]) {
    byId(id).replaceChildren(...titles.map((title, n) => new Option(title, n)));
  }
  byId("film-a-label").hidden = about.films.length < 2;
  fillLayers();
  fillFilm();
}

function fillLayers() {
  const offered = about.layers.filter((one) => film().layers.includes(one.name));
  byId("layer").replaceChildren(...offered.map((one) => new Option(one.title, one.name)),
    new Option("flags", "flags"));
  byId("layer").value = state.layer;
}

function fillFilm() {
  const one = film();
  document.title = byId("run").textContent = one.name || one.file;
  byId("trigger").max = lastOf("a");
  byId("trigger-number").max = one.numbers.at(-1);
  fillOther();
  // a cycle in half a minute
  byId("stride").value = Math.max(1, Math.round(one.numbers.length / 250));
  state.window = [0, 0, one.width, one.height];
  state.region = [...one.region];
  state.line = [...one.line];
  fillForms();
}

async function chooseFilm(which, number) {
  state[which].film = number;
  state[which].trigger = Math.min(state[which].trigger, lastOf(which));
  forgetLimits(...Object.keys(state.limits).filter((layer) => which === "a"
    || state.fitted[layer] !== null));
  if (which === "a") {
    fillFilm();
    if (![...film().layers, "flags"].includes(state.layer)) state.layer = "thickness";
    fillLayers();
  }
  const refused = state.two ? matchGrids() : "";
  fillOther();
  await loadCycles();
  await setTrigger(state.a.trigger);
  if (refused) report(refused, true);
}

const cycles = new Map();

async function loadCycles() {
  for (const name of ["a", "b"]) {
    const number = state[name].film;
    if (!cycles.has(number)) {
      cycles.set(number, await ask.cycle({ film: number }));
    }
  }
  const axes = cycles.get(state.a.film).axes;
  const before = byId("axis").value;
  byId("axis").replaceChildren(...Object.entries(axes).map(([name, title]) =>
    new Option(title, name)));
  if (before in axes) byId("axis").value = before;
  byId("paired").textContent = {
    crank_angle: "at the angle of the first",
    encoder_angle: "at the angle and stroke of the first",
  }[state.a.film === state.b.film ? "" : pairedBy()] ?? "same trigger as the first";
  cycleChart.build();
}

function on(id, event, action) {
  byId(id).addEventListener(event, guarded(action));
}

function connect() {
  on("trigger", "input", () => setTrigger(byId("trigger").valueAsNumber));
  on("trigger-number", "change", () => typeTrigger("trigger-number", "a"));
  on("trigger-b", "change", () => {
    state.linked = byId("linked").checked = false;
    return typeTrigger("trigger-b", "b");
  });
  on("linked", "change", () => {
    state.linked = byId("linked").checked;
    return setTrigger(state.a.trigger);
  });
  on("previous", "click", () => step(-1));
  on("next", "click", () => step(1));
  on("play", "click", play);
  on("film-a", "change", () => chooseFilm("a", Number(byId("film-a").value)));
  on("film-b", "change", () => chooseFilm("b", Number(byId("film-b").value)));
  on("layer", "change", () => {
    state.layer = byId("layer").value;
    showLimits();
    return refreshAll();
  });
  on("unit", "change", () => {
    state.unit = byId("unit").value;
    return refreshAll();
  });
  for (const id of ["low", "high"]) {
    on(id, "change", () => {
      const found = [byId("low").valueAsNumber, byId("high").valueAsNumber];
      if (!(found[0] < found[1])) throw new Error("The colours need two numbers, low before high.");
      report("");
      state.limits[state.layer] = found;
      state.fitted[state.layer] = null;
      redraw();
    });
  }
  on("fit", "click", () => {
    forgetLimits(state.layer, state.unit);
    return refreshMaps();
  });
  for (const radio of document.getElementsByName("tool")) {
    radio.addEventListener("change", () => {
      state.tool = radio.value;
      Object.values(panels).forEach((panel) =>
        panel.canvas.classList.toggle("draws", state.tool !== "move"));
    });
  }
  on("closer", "click", () => panels.a.zoom(0.5));
  on("wider", "click", () => panels.a.zoom(2));
  on("whole", "click", () => panels.a.zoom(Infinity));
  on("two", "change", () => showTwo(byId("two").checked));
  on("axis", "change", () => cycleChart.build());
  on("zero", "change", () => cycleChart.build());
  for (const [form, names] of Object.entries(FORMS)) {
    on(`${form}-form`, "submit", (event) => {
      event.preventDefault();
      const { elements } = byId(`${form}-form`);
      const found = names.map((name) => elements[name].valueAsNumber);
      const falls = form === "region" && (found[0] >= found[1] || found[2] >= found[3]);
      if (falls || !found.every(Number.isFinite)) throw new Error(WANTED[form]);
      state[form] = found;
      if (form === "line") state.width = Math.max(1, elements.width.valueAsNumber || 1);
      drawn(form);
    });
  }
  on("what", "change", allowExports);
  on("png", "click", exportPicture);
  on("csv", "click", () => exportData("csv"));
  on("tiff", "click", () => exportData("tiff"));
  on("write", "click", proposeRegion);
  on("confirm-yes", "click", writeRegion);
  on("confirm-no", "click", () => byId("confirm").close());
  document.addEventListener("keydown", pressed);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    redraw();
    profileChart.redraw();
    cycleChart.redraw();
  });
  new ResizeObserver(() => {
    Object.values(panels).forEach((panel) => panel.resize());
    profileChart.resize();
    cycleChart.resize();
  }).observe(document.body);
}

// Arrows on the map move what is drawn by a pixel of the map or, zoomed out, about one of the screen.
function moveDrawn(event) {
  const across = { ArrowLeft: -1, ArrowRight: 1 }[event.key] ?? 0;
  const down = { ArrowUp: -1, ArrowDown: 1 }[event.key] ?? 0;
  const drawing = state.tool === "line" ? "line" : "region";
  const places = state[drawing];
  if (!places || (!across && !down)) return false;
  const pixels = Math.max(1, Math.round((state.window[2] - state.window[0]) / 400));
  const [dx, dy] = [across * pixels * film().x[1], down * pixels * film().y[1]];
  const change = drawing === "line" ? [dx, dy, dx, dy] : [dx, dx, dy, dy];
  if (event.shiftKey) for (const n of drawing === "line" ? [0, 1] : [0, 2]) change[n] = 0;
  const moved = places.map((value, n) => value + change[n]);
  if (drawing === "region" && (moved[0] >= moved[1] || moved[2] >= moved[3])) return true;
  state[drawing] = moved;
  drawn(drawing);
  return true;
}

function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("confirm").open) return;
  const target = event.target;
  const types = target.matches("input:not([type=checkbox]):not([type=radio]), select, textarea");
  if (types && target.id !== "trigger") return;
  if (target.matches("canvas") && state.tool !== "move" && moveDrawn(event)) {
    event.preventDefault();
    return;
  }
  const many = event.shiftKey ? 10 : 1;
  const last = lastOf("a");
  const actions = {
    ArrowLeft: () => step(-many), ArrowRight: () => step(many),
    Home: () => setTrigger(0), End: () => setTrigger(last),
    "+": () => panels.a.zoom(0.5), "-": () => panels.a.zoom(2), 0: () => panels.a.zoom(Infinity),
  };
  // arrows choose among radio buttons, and space presses what has the focus
  if (target.matches("input[type=radio]") && event.key.startsWith("Arrow")) return;
  const presses = target.matches("button, summary, input[type=checkbox], input[type=radio]");
  if (event.key === " " && !presses) actions[" "] = play;
  if (event.key in actions) {
    event.preventDefault();
    guarded(actions[event.key])();
  }
}

const start = guarded(async () => {
  about = await ask.films({});
  for (const [layer, limits] of Object.entries(about.limits ?? {})) {
    [state.limits[layer], state.fitted[layer]] = [limits, null]; // those of all triggers
  }
  state.a.trigger = film().first;
  if (about.films.length > 1) {
    state.b = { film: 1, trigger: Math.min(film().first, about.films[1].numbers.length - 1) };
    state.linked = byId("linked").checked = true;
  } else {
    const count = film().numbers.length;
    state.b.trigger = (film().first + Math.floor(count / 2)) % count;
  }
  byId("more").open = innerWidth > 640; // a narrow screen shows the map first
  makePanels();
  profileChart = new ProfileChart(byId("profile"), {
    pointed: (share) => {
      const [x0, y0, x1, y1] = state.line;
      state.mark = share === null ? null : [x0 + share * (x1 - x0), y0 + share * (y1 - y0)];
      redraw();
    },
  });
  cycleChart = new CycleChart(byId("cycle"), {
    state, cycles, axis: () => byId("axis").value, zero: () => byId("zero").checked,
    chosen: guarded((number, trigger) => {
      const second = number !== state.a.film && state.two && number === state.b.film;
      return setTrigger(trigger, second && !state.linked ? "b" : "a");
    }),
  });
  fillControls();
  fillExports();
  connect();
  showTrigger();
  await refreshMaps(); // the map first, all else after it
  profileChart.build(1);
  await loadCycles();
  if (state.linked) state.b.trigger = partner(state.a.trigger);
  showTrigger();
  await refreshValues();
  document.body.dataset.ready = "yes";
});
start();
