// The page of `erlif watch --setup`: both cameras, their histograms, and what to turn.
import { MapPanel } from "./map.js";
import { Histogram } from "./histogram.js";
import { byId, element } from "./draw.js";
import { fixed, follow, listIn, percent, showAge, showFaults } from "./news.js";
import { get } from "./server.js";

const about = await (await get("run")).json();
const views = [1, 2].map(() => ({ window: null, limits: {}, tool: "move" }));
let film = null;
let news = {};

const histograms = [1, 2].map((n) => new Histogram(byId(`histogram-${n}`)));
const panels = [1, 2].map((n) => new MapPanel(byId(`panel-${n}`), {
  about, state: views[n - 1], film: () => film, layer: () => `camera${n}`,
  load: async (view) => (await get("map", { ...view, layer: `camera${n}`, after: -1 })).arrayBuffer(),
  shown: (found) => {
    views[n - 1].limits[`camera${n}`] = found.limits;
  },
}));

const rows = [
  ["mean count", ({ mean }) => `${fixed(mean, 0)} DN`],
  ["dark level", ({ dark }) => (dark === null ? "no darks yet" : `${fixed(dark, 1)} DN`)],
  ["brightest 0.1 %", ({ highest, full_scale }) =>
    `${fixed(100 * highest, 0)} % of ${full_scale} DN`],
  ["saturated", ({ saturated }) => percent(saturated)],
  ["sharpness, and the best so far", ({ sharpness }, n) =>
    `${fixed(sharpness, 3)}, ${fixed(news.best[n], 3)}`],
  ["pixels that can be measured", ({ measurable }) => percent(measurable)],
];

const row = (kind, texts) =>
  element("tr", ...texts.map((text, n) => element(n ? kind : "th", text)));

function showChecks() {
  const table = [row("th", ["", "camera 1", "camera 2"])];
  for (const [title, text] of rows) table.push(row("td", [title, ...news.cameras.map(text)]));
  const { map } = news;
  if (map) {
    table.push(row("td", ["displacement of camera 2", "",
      `${fixed(map.shift[0], 1)}, ${fixed(map.shift[1], 1)} px`]));
    table.push(row("td", ["overlap with camera 1", "", percent(map.overlap)]));
    table.push(row("td", ["correlation of the textures", "", fixed(map.quality, 2)]));
  }
  byId("checks").replaceChildren(...table);
}

setInterval(() => showAge(news), 1000);
addEventListener("resize", () => {
  panels.forEach((panel) => panel.resize());
  histograms.forEach((chart) => chart.resize());
});
byId("run").textContent = `${about.name}: setup`;
await follow(() => ({ pairs: 0, angles: 0 }), (found) => {
  news = found;
  showFaults(news);
  showAge(news);
  const ready = news.cameras.length ? ["Nothing: both cameras are within their ranges."] : [];
  listIn("advice", news.advice.length ? news.advice : ready);
  if (!news.newest || !news.shape) return;
  const [height, width] = news.shape;
  film ??= { x: [0, about.pitch], y: [0, about.pitch], width, height,
    labels: ["x [mm]", "y [mm]"] };
  views.forEach((view) => {
    view.window ??= [0, 0, width, height];
  });
  showChecks();
  news.cameras.forEach((camera, n) => histograms[n].show(camera));
  if (news.newest.place !== Number(document.body.dataset.asked)) {
    document.body.dataset.asked = news.newest.place;
    panels.forEach((panel) => panel.refresh().catch(() => {}));
  }
});
