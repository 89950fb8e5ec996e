// The page of `erlif watch --setup`: both cameras, their histograms, and what to turn.
import { MapPanel } from "./map.js";
import { fitToWindow, showCameras } from "./cameras.js";
import { byId } from "./draw.js";
import { fixed, follow, listIn, percent, showAge, showFaults } from "./news.js";
import { get } from "./server.js";

const about = await (await get("run")).json();
const views = [1, 2].map(() => ({ window: null, limits: {}, tool: "move" }));
let film = null;
let news = {};

const panels = [1, 2].map((n) => new MapPanel(byId(`panel-${n}`), {
  about, state: views[n - 1], film: () => film, layer: () => `camera${n}`,
  load: async (view) => (await get("map", { ...view, layer: `camera${n}`, after: -1 })).arrayBuffer(),
  shown: (found) => {
    views[n - 1].limits[`camera${n}`] = found.limits;
  },
}));

const rows = () => [
  ["dark level", ({ dark }) => (dark === null ? "no darks yet" : `${fixed(dark, 1)} DN`)],
  ["sharpness, and the best so far", ({ sharpness }, n) =>
    `${fixed(sharpness, 3)}, ${fixed(news.best[n], 3)}`],
  ["pixels that can be measured", ({ measurable }) => percent(measurable)],
  ...(news.map ? ofCamera2(news.map) : []),
];

const ofCamera2 = ({ shift, overlap, quality }) => [
  ["displacement of camera 2", `${fixed(shift[0], 1)}, ${fixed(shift[1], 1)} px`],
  ["overlap with camera 1", percent(overlap)],
  ["correlation of the textures", fixed(quality, 2)],
].map(([title, text]) => [title, (camera, n) => (n ? text : "")]);

setInterval(() => showAge(news), 1000);
fitToWindow(panels);
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
  showCameras(news.cameras, rows());
  if (news.newest.place !== Number(document.body.dataset.asked)) {
    document.body.dataset.asked = news.newest.place;
    panels.forEach((panel) => panel.refresh().catch(() => {}));
  }
});
