// The page of `erlif watch`: the newest map, the film over the run, and alarms.
import { MapPanel } from "./map.js";
import { Chart, axis, drawBars, ink } from "./charts.js";
import { byId, showKey } from "./draw.js";
import { fixed, follow, pause, percent, showAge, showFaults } from "./news.js";
import { get } from "./server.js";

const MOST = 2000; // pairs that a chart shows, the latest
const SINCE = "time since the first pair [s]";
const QUICK = 200; // maps that follow each other in less have half the detail, in milliseconds

let about = null;
let panel = null;
let first = Infinity; // time of the first pair
const WHOLE = [0, 0, 65536, 65536]; // of a map whose size is not known yet
let state = { window: WHOLE, limits: {}, tool: "move" };
let film = { x: [0, 1], y: [0, 1], width: 65536, height: 65536, labels: ["x [mm]", "y [mm]"] };
let news = { version: -1 };
let quick = false;
let place = -1; // of the pair on the page
let ended = false;
const pairs = [];
const angles = []; // of the encoder, by place in the recording

// the map

// the newest map, as soon as it is of a later pair than `after`
async function loadMap(view, after) {
  const query = { ...view, layer: "thickness", coarse: +quick, after };
  return (await get("map", query)).arrayBuffer();
}

function makePanel() {
  panel = new MapPanel(byId("panel"), {
    about, state, film: () => film, layer: () => "thickness",
    load: (view) => loadMap(view, -1),
    shown: (found) => {
      place = found.place;
      if (state.window === WHOLE) {
        const [, , width, height] = state.window = found.window;
        film = { ...film, width, height, x: [0, about.pitch], y: [0, about.pitch] };
      }
      if (!byId("hold").checked) state.limits.thickness = found.limits.map((v) => +v.toPrecision(3));
      showKey(about.flags, about.flags.map(({ name }, n) =>
        found.shares[n] && `${name}: ${(100 * found.shares[n]).toFixed(1)} %`));
      document.body.dataset.shown = found.text;
      document.body.dataset.time = Date.now() / 1000;
    },
  });
}

// the charts

class RunChart extends Chart {
  constructor(place, tall, unit, series) {
    super(place);
    [this.tall, this.unit, this.series] = [tall, unit, series];
    this.across = null;
  }

  show(places, columns, across) {
    const data = [places, ...columns.map(({ value }) => value)];
    if (!this.plot || this.across !== across) {
      this.across = across;
      this.make({
        scales: { x: { time: false } },
        series: [{ label: across }, ...this.series.map(({ label, colour }) => ({
          label, stroke: ink(colour), paths: () => null, points: { show: true, size: 4,
            stroke: ink(colour), fill: ink(colour) } }))],
        axes: [{ ...axis(across), size: 34 }, { ...axis(this.unit), size: 52 }],
        cursor: { drag: { x: true, y: false }, points: { show: false } },
        legend: { live: false, markers: { fill: (u, k) => u.series[k].stroke(u, k) } },
        hooks: { draw: [(u) => this.drawBars(u)] },
      }, data);
    }
    this.columns = columns;
    this.plot.setData(data);
  }

  drawBars(u) {
    (this.columns ?? []).forEach(({ value, std }, k) => std && drawBars(u,
      ink(this.series[k].colour)(), u.data[0].map((place, n) => [place, value[n], std[n]])));
  }
}

const charts = {
  film: new RunChart(byId("film"), 240, "film thickness [µm]", [
    { label: "minimum", colour: "--second" }, { label: "mean", colour: "--first" }]),
  light: new RunChart(byId("lights"), 170, "mean count [DN]", [
    { label: "camera 1", colour: "--first" }, { label: "camera 2", colour: "--second" }]),
  drift: new RunChart(byId("drifts"), 170, "drift [px]", [
    { label: "x", colour: "--first" }, { label: "y", colour: "--second" }]),
};

function showCharts() {
  const shown = pairs.slice(-MOST).sort((one, two) => one.place - two.place);
  if (!shown.length) return;
  first = Math.min(...shown.map((pair) => pair.time), first);
  const byAngle = byId("axis").value === "angle";
  const rows = byAngle
    ? shown.filter((pair) => angles[pair.place] !== undefined)
      .sort((one, two) => angles[one.place] - angles[two.place])
    : shown;
  const places = rows.map((pair) => (byAngle ? angles[pair.place] : pair.time - first));
  charts.film.show(places, [
    { value: rows.map((p) => p.film_min), std: rows.map((p) => p.film_min_std) },
    { value: rows.map((p) => p.film_mean), std: rows.map((p) => p.film_mean_std) },
  ], byAngle ? "encoder angle [°]" : SINCE);
  const times = shown.map((pair) => pair.time - first);
  for (const name of ["light", "drift"]) {
    const columns = [0, 1].map((k) => ({ value: shown.map((pair) => pair[name][k]) }));
    charts[name].show(times, columns, SINCE);
  }
}

// the numbers

function showNumbers() {
  const newest = news.newest;
  byId("pairs").textContent = `${news.measured} / ${news.arrived}`;
  byId("frames").textContent = news.frames.join(" / ");
  for (const [name, unit, digits] of [["joint_load", "N", 0], ["temperature", "°C", 1]]) {
    if (!(name in news.logged)) continue;
    byId(name).textContent = `${fixed(news.logged[name], digits)} ${unit}`;
    byId(name).parentElement.hidden = false;
  }
  if (!newest) return;
  for (const name of ["film_min", "film_mean"]) {
    byId(name).textContent = `${fixed(newest[name], 2)} ± ${fixed(newest[`${name}_std`], 2)} µm`;
  }
  byId("valid").textContent = percent(newest.valid);
  byId("light").textContent = `${newest.light.map((v) => fixed(v, 0)).join(" / ")} DN`;
  byId("saturated").textContent = newest.saturated.map(percent).join(" / ");
  byId("drift").textContent = `${newest.drift.map((v) => fixed(v, 2)).join(", ")} px`;
}

// alarms

let speaker = null;
function beep() {
  speaker ??= new AudioContext();
  const [tone, level] = [speaker.createOscillator(), speaker.createGain()];
  tone.frequency.value = 880;
  level.gain.value = 0.2;
  tone.connect(level).connect(speaker.destination);
  tone.start();
  tone.stop(speaker.currentTime + 0.3);
}

function showAlarms() {
  const texts = Object.values(news.alarms);
  byId("alarm").hidden = !texts.length;
  byId("alarm").textContent = texts.join("; ");
  document.body.classList.toggle("alarm", texts.length > 0);
  document.title = `${texts.length ? "ALARM " : ""}${about.name} – erlif watch`;
}
setInterval(() => {
  showAge(news);
  if (byId("sound").checked && Object.keys(news.alarms ?? {}).length) beep();
}, 1000);

// news

function show(found) {
  news = found;
  pairs.length = news.after;
  pairs.push(...news.pairs);
  angles.push(...news.angles);
  showNumbers();
  showFaults(news);
  showAlarms();
  showAge(news);
  requestAnimationFrame(showCharts);
}

function showInFull() {
  quick = false;
  panel.refresh().catch(() => {});
}

// shows every map that is newer than the one on the page, until the recording ends
async function followMaps() {
  let shown = -Infinity;
  let settled = 0;
  while (!ended) {
    const before = place;
    const data = await loadMap(panel.view(), place).catch(() => null);
    if (data === null) { // none yet
      await pause();
      continue;
    }
    panel.show(data);
    if (place === before) continue;
    quick = performance.now() - shown < QUICK;
    shown = performance.now();
    clearTimeout(settled);
    if (quick) settled = setTimeout(showInFull, 2 * QUICK);
  }
}

byId("axis").addEventListener("change", showCharts);
addEventListener("resize", () => {
  panel?.resize();
  Object.values(charts).forEach((chart) => chart.resize());
});
about = await (await get("run")).json();
byId("run").textContent = about.name;
makePanel();
followMaps();
await follow(() => ({ pairs: pairs.length, angles: angles.length }), show);
ended = true;
