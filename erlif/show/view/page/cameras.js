// Both cameras side by side: histograms of the counts, and a table of what is checked.
import { Chart, axis, ink } from "./charts.js";
import { byId, element } from "./draw.js";
import { fixed, percent } from "./news.js";

// counts of an image, in a logarithmic scale
class Histogram extends Chart {
  constructor(place) {
    super(place);
    this.tall = 150;
  }

  show({ histogram, full_scale }) {
    const places = histogram.map((_, n) => (n * full_scale) / histogram.length);
    const data = [places, histogram.map((count) => Math.max(count, 0.5))];
    if (this.plot) {
      this.plot.setData(data);
      return;
    }
    this.make({
      scales: { x: { time: false, range: [0, full_scale] }, y: { distr: 3 } },
      series: [{ label: "count" }, { label: "pixels", stroke: ink("--first"), width: 1.5,
        paths: uPlot.paths.stepped({ align: 1 }), points: { show: false } }],
      axes: [{ ...axis("count [DN]"), size: 34 }, { ...axis("pixels"), size: 52 }],
      legend: { show: false },
      cursor: { show: false },
    }, data);
  }
}

const histograms = [1, 2].map((n) => new Histogram(byId(`histogram-${n}`)));

const LEVELS = [
  ["mean count", ({ mean }) => `${fixed(mean, 0)} DN`],
  ["brightest 0.1 %", ({ highest, full_scale }) =>
    `${fixed(100 * highest, 0)} % of ${full_scale} DN`],
  ["saturated", ({ saturated }) => percent(saturated)],
];

const row = (kind, texts) =>
  element("tr", ...texts.map((text, n) => element(n ? kind : "th", text)));

// histograms and checks; `more` has titles, and functions of a camera and its place
export function showCameras(cameras, more = []) {
  cameras.forEach((camera, n) => histograms[n].show(camera));
  byId("checks").replaceChildren(row("th", ["", "camera 1", "camera 2"]),
    ...[...LEVELS, ...more].map(([title, text]) => row("td", [title, ...cameras.map(text)])));
}

// images and histograms are as wide as the window has room
export function fitToWindow(panels) {
  addEventListener("resize", () => [...panels, ...histograms].forEach((one) => one.resize()));
}
