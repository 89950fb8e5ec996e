// Histogram of the counts of an image, in a logarithmic scale.
import { Chart, axis, ink } from "./charts.js";

export class Histogram extends Chart {
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
