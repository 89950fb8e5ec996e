// The charts beside the maps, drawn by uPlot.
import { css } from "./draw.js";

const FONT = '12px system-ui, "DejaVu Sans", sans-serif';

export const axis = (label) => ({
  label,
  labelSize: 20,
  labelGap: 0,
  labelFont: FONT,
  font: FONT,
  stroke: () => css("--ink").trim(),
  grid: { stroke: () => css("--grid").trim(), width: 1 },
  ticks: { stroke: () => css("--line").trim(), width: 1, size: 5 },
});
export const ink = (name) => () => css(name).trim();

export class Chart {
  constructor(place) {
    this.place = place;
    this.plot = null;
  }

  make(options, data) {
    this.plot?.destroy();
    this.plot = new uPlot({ ...this.size(), ...options }, data, this.place);
  }

  size() {
    return { width: Math.max(200, this.place.clientWidth), height: this.tall };
  }

  resize() {
    const size = this.size();
    if (this.plot && this.plot.width !== size.width) this.plot.setSize(size);
  }

  redraw() {
    this.plot?.redraw(false, true);
  }

  canvas() {
    return this.plot.ctx.canvas;
  }
}

export class ProfileChart extends Chart {
  constructor(place, use) {
    super(place);
    this.use = use;
    this.tall = 230;
    this.label = "";
  }

  build(count) {
    const series = [{ label: "mm", value: (u, v) => (v === null ? "" : v?.toFixed(3)) }];
    const bands = [];
    for (let n = 0; n < count; n++) {
      const colour = n ? "--second" : "--first";
      const value = (u, v) => (v === null || v === undefined ? "" : v.toPrecision(4));
      const label = count > 1 ? ["first", "second"][n] : "value";
      series.push({ label, stroke: ink(colour), width: 1.5, value, points: { show: false } });
      for (const edge of ["above", "below"]) {
        series.push({ label: edge, width: 0, stroke: "transparent", class: "u-off-legend",
          points: { show: false } });
      }
      series.push({ label: "predicted", stroke: ink("--ink"), width: 1.5, dash: [6, 4], value,
        points: { show: false } });
      bands.push({ series: [4 * n + 2, 4 * n + 3],
        fill: () => `color-mix(in srgb, ${css(colour).trim()} 28%, transparent)` });
    }
    const x = { ...axis("distance along the line [mm]"), size: 34 };
    this.make({
      scales: { x: { time: false } },
      series, bands,
      axes: [x, { ...axis(() => this.label), size: 52 }],
      cursor: { y: false, drag: { x: true, y: false } },
      legend: { live: true },
      hooks: {
        setCursor: [(u) => {
          const { idx } = u.cursor;
          const places = u.data[0];
          const share = idx === null || idx === undefined ? null
            : places[idx] / places[places.length - 1];
          if (share !== this.share) this.use.pointed(this.share = share);
          u.root.classList.toggle("idle", share === null);
        }],
      },
    }, [[0, 1], ...Array.from({ length: 4 * count }, () => [null, null])]);
    this.plot.root.classList.add("idle"); // no values without a pointer
    this.plot.root.classList.toggle("one", count === 1);
    this.count = count;
  }

  show(found, label) {
    if (!this.plot || this.count !== found.length) this.build(found.length);
    this.label = label;
    const data = [found[0].position];
    for (const one of found) {
      const edge = (sign) => one.value.map((v, n) =>
        (v === null || one.std[n] === null ? null : v + sign * one.std[n]));
      data.push(one.value, edge(1), edge(-1), one.predicted ?? one.value.map(() => null));
    }
    this.found = found;
    const hidden = found.some((one) => one.predicted) ? /above|below/ : /above|below|predicted/;
    for (const row of this.plot.root.querySelectorAll(".u-legend tr")) {
      row.hidden = hidden.test(row.textContent);
    }
    this.plot.setData(data);
  }
}

// blue for means, orange for minima; lines are theory, and their dashes distinguish them
const LOOKS = {
  film_mean: { colour: "--first", mark: true },
  film_min: { colour: "--second", mark: true },
  film_theory: { colour: "--second", dash: [], border: "solid" },
  film_hamrock_dowson: { colour: "--theory", dash: [2, 3], border: "dotted" },
  film_predicted_min: { colour: "--second", dash: [8, 4], border: "dashed" },
  film_predicted_mean: { colour: "--first", dash: [8, 4], border: "dashed" },
};

// Along these the triggers follow each other, so that a line between them is meant.
const ALONG = ["encoder_angle", "crank_angle", "time", "position", "trigger"];
const TIMES = ["time", "trigger"]; // of these, also over several turns of the drive
const GAP = 1.75; // step over the longer steps of a line above which nothing was measured

// Steps of a line at which it is cut because nothing was measured in them: from, to.
function cuts(places) {
  const steps = places.slice(1).map((place, n) => place - places[n]);
  if (steps.length < 2) return [];
  const long = [...steps].sort((a, b) => a - b)[Math.floor(0.95 * (steps.length - 1))];
  return steps.flatMap((step, n) => (step > GAP * long ? [[places[n], places[n + 1]]] : []));
}

// Whether the triggers are those of several turns, which a line by angle would join.
const hasTurns = ({ columns }) => (columns.crank_angle ?? [])
  .filter((place, n, all) => n && place < all[n - 1]).length > 1;

// Ends of the horizontal axis with room for whole markers.
function widen(low, high) {
  const room = 0.02 * (high - low) || 1;
  return [low - room, high + room];
}

// Bars of one standard deviation, of [place, value, std]; those that are shorter are left out.
export function drawBars(u, colour, bars, shortest = 0) {
  const { left, top, width, height } = u.bbox;
  u.ctx.save();
  u.ctx.beginPath();
  u.ctx.rect(left, top, width, height);
  u.ctx.clip();
  u.ctx.lineWidth = devicePixelRatio;
  u.ctx.strokeStyle = colour;
  u.ctx.beginPath();
  for (const [place, value, std] of bars) {
    if (value === null || std === null) continue;
    const [x, y] = [u.valToPos(place, "x", true), u.valToPos(value, "y", true)];
    const half = y - u.valToPos(value + std, "y", true);
    if (half < shortest) continue;
    u.ctx.moveTo(x, y - half);
    u.ctx.lineTo(x, y + half);
  }
  u.ctx.stroke();
  u.ctx.restore();
}

export class CycleChart extends Chart {
  constructor(place, use) {
    super(place);
    this.use = use;
    this.tall = 260;
    place.addEventListener("click", (event) => this.choose(event));
  }

  // One row for each trigger of the films that are shown, in the order of the horizontal axis;
  // a column for each film thickness, stroke and film.
  build() {
    const { state, cycles } = this.use;
    if (!cycles.has(state.a.film)) return;
    const name = this.use.axis();
    const numbers = [state.a.film];
    if (state.two && state.b.film !== state.a.film && cycles.has(state.b.film)) {
      numbers.push(state.b.film);
    }
    const rows = [];
    const columns = [];
    const strokesOf = ({ number }) =>
      [...new Set(cycles.get(number).stroke)].sort((one, two) => two - one);
    numbers.forEach((number, second) => {
      const cycle = cycles.get(number);
      const places = cycle.columns[name];
      if (!places) return;
      places.forEach((place, trigger) => {
        if (place !== null) rows.push({ place, number, trigger, stroke: cycle.stroke[trigger] });
      });
      const strokes = strokesOf({ number });
      for (const [film, title] of Object.entries(cycle.films)) {
        if (second && !LOOKS[film].mark) continue; // the second film is shown by its data
        for (const stroke of strokes) {
          columns.push({ number, film, stroke, title, second });
        }
      }
    });
    // rows without a trigger cut the lines of a stroke
    const isOf = (row, one) => row.number === one.number && row.stroke === one.stroke;
    const gaps = new Map();
    const lines = columns.filter(({ film, number }) =>
      film === Object.keys(cycles.get(number).films)[0]);
    for (const one of lines) {
      const places = rows.filter((row) => isOf(row, one)).map((row) => row.place);
      places.sort((a, b) => a - b);
      const found = cuts(places);
      gaps.set(`${one.number},${one.stroke}`, found);
      for (const [from, to] of found) {
        rows.push({ ...one, place: (from + to) / 2, trigger: null });
      }
    }
    rows.sort((one, two) => one.place - two.place);
    this.rows = rows;
    const data = [rows.map((row) => row.place)];
    for (const one of columns) {
      const values = cycles.get(one.number).columns[one.film];
      const own = gaps.get(`${one.number},${one.stroke}`);
      const isCut = ({ place }) => own.some(([from, to]) => place > from && place < to);
      // undefined: a row of another line, which does not cut this one
      data.push(rows.map((row) => {
        if (isOf(row, one) && row.trigger !== null) return values[row.trigger];
        return LOOKS[one.film].mark || isCut(row) ? null : undefined;
      }));
    }
    const limits = numbers.map((number) => cycles.get(number).limits);
    const least = Math.min(...limits.map(([low]) => low));
    const most = Math.max(...limits.map(([, high]) => high));
    const fromZero = this.use.zero();
    const outside = ({ number, film }) => !fromZero
      && !cycles.get(number).columns[film].some((v) => v !== null && v >= least && v <= most);
    const turns = numbers.some((number) => hasTurns(cycles.get(number)));
    const along = ALONG.includes(name) && (!turns || TIMES.includes(name));
    this.make({
      scales: { x: { time: false, range: (u, low, high) => widen(low, high) }, y: { range: (u, low, high) => (fromZero
        ? [Math.min(0, low ?? 0), 1.05 * (high ?? 1)] : [least, most]) } },
      series: [{ label: cycles.get(state.a.film).axes[name] ?? name }, ...columns.map((one) =>
        look({ ...one, along, outside: outside(one) }, rows.length > 600 ? 4 : 7))],
      axes: [{ ...axis(cycles.get(state.a.film).axes[name] ?? name), size: 34 },
        { ...axis("film thickness [µm]"), size: 48 }],
      cursor: { drag: { x: true, y: false }, points: { show: false } },
      legend: { live: false,
        markers: {
          dash: (u, k) => LOOKS[columns[k - 1]?.film]?.border ?? "solid",
          fill: (u, k) => (LOOKS[columns[k - 1]?.film]?.mark && columns[k - 1].stroke >= 0
            ? u.series[k].stroke(u, k) : "transparent"),
        } },
      hooks: { drawAxes: [(u) => columns.forEach((one, k) => { // behind the markers
        const std = cycles.get(one.number).columns[`${one.film}_std`];
        const { show, points, stroke } = u.series[k + 1];
        if (!std || !show) return;
        const values = rows.map(({ place, trigger }, n) =>
          [place, u.data[k + 1][n] ?? null, std[trigger]]);
        const least = LOOKS[one.film].mark ? (points.size / 2) * devicePixelRatio : 1;
        drawBars(u, stroke(u, k + 1), values, least);
      })],
        draw: [() => this.mark()], setSize: [() => this.mark()] },
    }, data);
    // one entry for the lines of a theory on both strokes
    [...this.plot.root.querySelectorAll(".u-series")].slice(-columns.length).forEach((row, k) => {
      row.classList.toggle("line", !LOOKS[columns[k].film].mark);
      row.hidden = !LOOKS[columns[k].film].mark && columns[k].stroke !== strokesOf(columns[k])[0];
    });
    this.here = ["a", "b"].map((which) => {
      const line = document.createElement("div");
      line.className = `here ${which}`;
      this.plot.over.append(line);
      return line;
    });
    this.mark();
  }

  mark() {
    if (!this.plot || !this.here) return;
    const { state, cycles } = this.use;
    const name = this.use.axis();
    ["a", "b"].forEach((which, n) => {
      const place = cycles.get(state[which].film)?.columns[name]?.[state[which].trigger];
      const shown = place !== null && place !== undefined && (n === 0 || state.two);
      this.here[n].hidden = !shown;
      if (shown) this.here[n].style.left = `${this.plot.valToPos(place, "x")}px`;
    });
  }

  choose(event) {
    const u = this.plot;
    if (!u || !u.over.contains(event.target)) return;
    const box = u.over.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    let best = null;
    let least = Infinity;
    this.rows.forEach((row, n) => {
      const across = u.valToPos(row.place, "x") - x;
      if (Math.abs(across) > least) return;
      for (let k = 1; k < u.data.length; k++) {
        if (!u.series[k].show || (u.data[k][n] ?? null) === null) continue;
        const distance = Math.hypot(across, u.valToPos(u.data[k][n], "y") - y);
        if (distance < least) [least, best] = [distance, row];
      }
    });
    if (best) this.use.chosen(best.number, best.trigger);
  }
}

function look({ film, stroke, title, second, along, outside }, size) {
  const { colour, mark, dash } = LOOKS[film];
  const name = stroke && mark ? `${title}, ${stroke > 0 ? "outward" : "return"}` : title;
  const label = `${name}${second ? ", second film" : ""}${outside ? " (outside the axis)" : ""}`;
  if (!mark) {
    const points = { show: !along, size: 3, stroke: ink(colour), fill: ink(colour) };
    return { label, stroke: ink(colour), width: 1.5, dash, spanGaps: false, points,
      ...(along ? {} : { paths: () => null }) };
  }
  // filled circles outward, open ones on the return; the second film is paler
  const tint = second ? () => `color-mix(in srgb, ${css(colour).trim()} 55%, ${css("--ink")})`
    : ink(colour);
  return { label, stroke: tint, paths: () => null,
    points: { show: true, size, stroke: tint,
      fill: stroke < 0 ? () => css("--ground").trim() : tint } };
}
