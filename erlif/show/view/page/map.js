// A map on a canvas: colours, axes, colour bar, and what is drawn over it.
import {
  circle, css, drawBar, latest, lengthOf, signed, strokeOver, ticks, triples, write, writeUpwards,
} from "./draw.js";

const EDGE = { left: 50, right: 82, top: 8, bottom: 38 }; // for axes and colour bar
const LOW_SCREEN = 300; // pixels that a map may always have in height

// bytes red, green, blue, opaque
const packed = (colours) =>
  Uint32Array.from(colours, ([r, g, b]) => ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0);

// a map as the server sends it
function unpack(data) {
  const length = new DataView(data).getUint32(0, true);
  const found = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
  const count = found.shape[0] * found.shape[1];
  const values = new Float32Array(data, 4 + length, count);
  return { ...found, values, flags: new Uint16Array(data, 4 + length + 4 * count, count) };
}

const EVERY = 7; // of the pixels, enough for a colour scale

// ends of a colour scale without the 0.5 % lowest and highest pixels; differences about zero
function limitsOf({ values, flags }, { palette }) {
  const found = values.filter((value, n) =>
    n % EVERY === 0 && !flags[n] && Number.isFinite(value)).sort();
  if (!found.length) return [0, 1];
  const [low, high] = [0.005, 0.995].map((share) => found[Math.round(share * (found.length - 1))]);
  const reach = Math.max(-low, high, 1e-3);
  return palette === "vik" ? [-reach, reach] : [low, Math.max(high, low + 1e-6)];
}

export class MapPanel {
  constructor(figure, use) {
    this.figure = figure;
    this.canvas = figure.querySelector("canvas");
    this.text = figure.querySelector("figcaption");
    this.use = { moved: () => this.refresh().catch(() => {}), ...use };
    this.shown = null; // description, values and flags on the screen
    this.pictures = document.createElement("canvas");
    this.colours = {};
    this.palettes = {};
    for (const [name, text] of Object.entries(use.about.palettes)) {
      this.colours[name] = triples(text);
      this.palettes[name] = packed(this.colours[name]);
    }
    this.flagColours = new Uint32Array(2 * Math.max(...use.about.flags.map((flag) => flag.bit)));
    for (let bits = 1; bits < this.flagColours.length; bits++) {
      const first = use.about.flags.find((flag) => bits & flag.bit);
      [this.flagColours[bits]] = first ? packed(triples(first.colour.slice(1))) : [0];
    }
    this.refresh = latest(() => this.load());
    this.listen();
  }

  async load() {
    if (this.figure.hidden) return;
    let data;
    const busy = setTimeout(() => this.figure.classList.add("busy"), 400); // most are faster
    try {
      data = await this.use.load(this.view());
    } catch (error) {
      this.shown = null;
      this.draw();
      throw error;
    } finally {
      clearTimeout(busy);
      this.figure.classList.remove("busy");
    }
    this.show(data);
  }

  // the part of the map that is to be shown, and its size on the screen
  view() {
    this.layout();
    const room = [this.width, this.height].map((length) => Math.round(length * devicePixelRatio));
    return { window: this.use.state.window.join(), room: room.join() };
  }

  show(data) {
    const found = data instanceof ArrayBuffer ? unpack(data) : data;
    found.limits = limitsOf(found, this.layer());
    this.shown = found;
    this.use.shown(found);
    this.draw();
    this.canvas.dataset.text = found.text;
    this.canvas.dataset.layer = this.use.layer();
    this.canvas.setAttribute("aria-label", this.caption());
    this.text.textContent = this.caption();
  }

  caption() {
    if (!this.shown) return "";
    const layer = this.layer();
    const step = this.shown.step;
    const detail = step > 1 ? `; one point is the mean of ${step} × ${step} pixels` : "";
    return `${layer.title}, ${this.shown.text}${detail}`;
  }

  layer() {
    const name = this.use.layer();
    if (name === "flags") return { title: "flags", unit: "", palette: null };
    return this.use.about.layers.find((one) => one.name === name);
  }

  // geometry: columns and rows of the map, and pixels of the screen

  layout() {
    const { state } = this.use;
    const film = this.use.film();
    const box = this.figure.clientWidth;
    const [l, t, r, b] = state.window;
    const tall = ((b - t) * film.y[1]) / ((r - l) * film.x[1]);
    this.width = Math.max(80, box - EDGE.left - EDGE.right);
    const most = Math.max(LOW_SCREEN, 0.62 * parent.innerHeight);
    this.height = Math.min(this.width * tall, most);
    this.width = this.height / tall;
    const ratio = devicePixelRatio;
    const whole = [this.width + EDGE.left + EDGE.right, this.height + EDGE.top + EDGE.bottom];
    const pixels = whole.map((length) => Math.round(length * ratio));
    if (this.canvas.width !== pixels[0] || this.canvas.height !== pixels[1]) {
      [this.canvas.width, this.canvas.height] = pixels;
    }
    this.canvas.style.width = `${whole[0]}px`;
    this.canvas.style.height = `${whole[1]}px`;
  }

  resize() {
    const wide = this.figure.clientWidth;
    if (!this.shown || wide === this.wide) return;
    this.wide = wide;
    this.draw();
    this.refresh().catch(() => {});
  }

  toScreen(x, y) {
    const film = this.use.film();
    const [l, t, r, b] = this.use.state.window;
    const column = (x - film.x[0]) / film.x[1] + 0.5;
    const row = (y - film.y[0]) / film.y[1] + 0.5;
    return [EDGE.left + ((column - l) / (r - l)) * this.width,
      EDGE.top + ((row - t) / (b - t)) * this.height];
  }

  fromScreen(event) {
    const film = this.use.film();
    const box = this.canvas.getBoundingClientRect();
    const [l, t, r, b] = this.use.state.window;
    const across = (event.clientX - box.left - EDGE.left) / this.width;
    const down = (event.clientY - box.top - EDGE.top) / this.height;
    const column = l + across * (r - l);
    const row = t + down * (b - t);
    return {
      inside: across >= 0 && across < 1 && down >= 0 && down < 1,
      column, row,
      x: film.x[0] + (Math.min(Math.max(column, 0), film.width) - 0.5) * film.x[1],
      y: film.y[0] + (Math.min(Math.max(row, 0), film.height) - 0.5) * film.y[1],
    };
  }

  // drawing

  draw() {
    if (this.figure.hidden) return;
    this.layout();
    const pen = this.canvas.getContext("2d");
    pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    if (!this.shown) return;
    this.paint();
    pen.save();
    pen.beginPath();
    pen.rect(EDGE.left, EDGE.top, this.width, this.height);
    pen.clip();
    pen.imageSmoothingEnabled = false; // a pixel of the map is a rectangle of one colour
    const [l, t, r, b] = this.use.state.window;
    const { step, shape, window } = this.shown;
    const scale = [this.width / (r - l), this.height / (b - t)];
    pen.drawImage(this.pictures, EDGE.left + (window[0] - l) * scale[0],
      EDGE.top + (window[1] - t) * scale[1], shape[1] * step * scale[0],
      shape[0] * step * scale[1]);
    this.drawOver(pen);
    pen.restore();
    this.drawAxes(pen);
    this.drawBar(pen);
  }

  paint() {
    const { shape, values, flags } = this.shown;
    const layer = this.layer();
    const palette = layer.palette && this.palettes[layer.palette];
    const [low, high] = this.use.state.limits[this.use.layer()] ?? this.shown.limits;
    const scale = 256 / (high - low);
    const [blank] = packed(triples(css("--raised").trim().slice(1)));
    const picture = new ImageData(shape[1], shape[0]);
    const pixels = new Uint32Array(picture.data.buffer);
    for (let n = 0; n < pixels.length; n++) {
      const bits = flags[n];
      if (bits) pixels[n] = this.flagColours[bits];
      else if (!palette || Number.isNaN(values[n])) pixels[n] = blank;
      else {
        const step = (values[n] - low) * scale;
        pixels[n] = palette[step < 0 ? 0 : step > 255 ? 255 : step | 0];
      }
    }
    [this.pictures.width, this.pictures.height] = [shape[1], shape[0]];
    this.pictures.getContext("2d").putImageData(picture, 0, 0);
  }

  drawOver(pen) {
    const { line, region, mark } = this.use.state;
    const stroke = (path) => strokeOver(pen, path);
    this.use.over?.(stroke, (x, y) => this.toScreen(x, y), pen);
    if (region) {
      const [x0, y0] = this.toScreen(region[0], region[2]);
      const [x1, y1] = this.toScreen(region[1], region[3]);
      stroke(() => pen.rect(x0, y0, x1 - x0, y1 - y0));
    }
    if (line) {
      const [x0, y0] = this.toScreen(line[0], line[1]);
      const [x1, y1] = this.toScreen(line[2], line[3]);
      stroke(() => {
        pen.moveTo(x0, y0);
        pen.lineTo(x1, y1);
      });
    }
    if (mark) circle(pen, this.toScreen(...mark), 6);
  }

  drawAxes(pen) {
    const film = this.use.film();
    const [l, t, r, b] = this.use.state.window;
    const at = (axis, place) => film[axis][0] + (place - 0.5) * film[axis][1];
    pen.strokeStyle = css("--ink");
    pen.lineWidth = 1;
    pen.strokeRect(EDGE.left - 0.5, EDGE.top - 0.5, this.width + 1, this.height + 1);
    for (const x of ticks(at("x", l), at("x", r), Math.max(2, this.width / 48))) {
      write(pen, signed(x), this.toScreen(x, 0)[0], EDGE.top + this.height + 11, "center");
    }
    for (const y of ticks(at("y", t), at("y", b), Math.max(2, this.height / 32))) {
      write(pen, signed(y), EDGE.left - 5, this.toScreen(0, y)[1], "right");
    }
    write(pen, film.labels[0], EDGE.left + this.width / 2, EDGE.top + this.height + 28,
      "center");
    writeUpwards(pen, film.labels[1], 9, EDGE.top + this.height / 2);
  }

  drawBar(pen) {
    const layer = this.layer();
    if (!layer.palette) return;
    const limits = this.use.state.limits[this.use.layer()] ?? this.shown.limits;
    const left = EDGE.left + this.width + 10;
    const most = Math.max(2, this.height / 32);
    const place = { left, top: EDGE.top, height: this.height, most };
    drawBar(pen, this.colours[layer.palette], limits, place);
    const title = `${layer.title} [${layer.unit}]`;
    const wide = lengthOf(pen, title);
    const room = this.height + EDGE.top + EDGE.bottom / 2;
    // a title longer than the map is smaller, down to 8 pixels
    const size = Math.max(8, Math.min(12, 12 * room / wide));
    const text = wide * size <= 12 * room ? title : `[${layer.unit}]`;
    writeUpwards(pen, text, left + 63, EDGE.top + this.height / 2, size);
  }

  // pointer: one finger or the mouse draws or moves, the wheel and two fingers zoom

  listen() {
    const { canvas } = this;
    const fingers = new Map();
    let from = null;
    let spread = 0;
    canvas.addEventListener("pointerdown", (event) => {
      const place = this.fromScreen(event);
      if (!place.inside || event.button) return;
      fingers.set(event.pointerId, event);
      canvas.setPointerCapture(event.pointerId);
      from = { ...place, window: [...this.use.state.window], clientX: event.clientX,
        clientY: event.clientY };
      spread = this.spread(fingers);
      this.use.pressed?.();
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!fingers.has(event.pointerId)) {
        const place = this.fromScreen(event);
        this.use.pointed?.(place.inside ? place : null);
        return;
      }
      fingers.set(event.pointerId, event);
      if (fingers.size === 2) {
        const now = this.spread(fingers);
        const [one, two] = [...fingers.values()];
        const middle = { clientX: (one.clientX + two.clientX) / 2,
          clientY: (one.clientY + two.clientY) / 2 };
        if (Math.abs(now - spread) > 4) this.zoom(spread / now, this.fromScreen(middle));
        spread = now;
      } else this.drag(from, event, "going");
    });
    const end = (event) => {
      if (!fingers.delete(event.pointerId)) return;
      if (!fingers.size && event.type === "pointerup") this.drag(from, event, "done");
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("wheel", (event) => {
      const place = this.fromScreen(event);
      // within a report the wheel alone scrolls the page
      if (!place.inside || (parent !== window && !event.ctrlKey)) return;
      event.preventDefault();
      this.zoom(event.deltaY > 0 ? 1.25 : 0.8, place);
    }, { passive: false });
    canvas.addEventListener("dblclick", () => this.use.state.tool === "move"
      && this.zoom(Infinity));
  }

  spread(fingers) {
    const [one, two] = [...fingers.values()];
    return two ? Math.hypot(one.clientX - two.clientX, one.clientY - two.clientY) : 0;
  }

  drag(from, event, phase) {
    const { state } = this.use;
    const moved = Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) > 3;
    if (!moved && phase === "going") return;
    const to = this.fromScreen(event);
    if (!moved && (state.tool === "move" || this.use.clicks)) return this.use.clicked?.(to);
    if (state.tool === "move") {
      const [l, t, r, b] = from.window;
      const across = ((event.clientX - from.clientX) / this.width) * (r - l);
      const down = ((event.clientY - from.clientY) / this.height) * (b - t);
      this.setWindow([l - across, t - down, r - across, b - down]);
    } else if (moved) {
      if (state.tool === "line") state.line = [from.x, from.y, to.x, to.y];
      else {
        state.region = [Math.min(from.x, to.x), Math.max(from.x, to.x), Math.min(from.y, to.y),
          Math.max(from.y, to.y)];
      }
      this.use.drawn?.(phase === "going" ? "going" : state.tool);
    }
  }

  zoom(factor, place = null) {
    const { state } = this.use;
    const film = this.use.film();
    const [l, t, r, b] = state.window;
    if (factor === Infinity) return this.setWindow([0, 0, film.width, film.height]);
    const wide = Math.min(Math.max((r - l) * factor, 8), film.width);
    const share = wide / (r - l);
    const column = place ? place.column : (l + r) / 2;
    const row = place ? place.row : (t + b) / 2;
    return this.setWindow([column - (column - l) * share, row - (row - t) * share,
      column + (r - column) * share, row + (b - row) * share]);
  }

  setWindow([l, t, r, b]) {
    const film = this.use.film();
    const across = Math.min(Math.max(l, 0), film.width - (r - l)) - l;
    const down = Math.min(Math.max(t, 0), film.height - (b - t)) - t;
    this.use.state.window = [l + across, t + down, r + across, b + down];
    this.draw();
    return this.use.moved();
  }
}
