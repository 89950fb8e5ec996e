"use strict";
// Viewer of the maps of the page: the map of one trigger, the values under the pointer, and the
// profile of the row that was clicked.
(() => {
  const film = JSON.parse(document.getElementById("film-data").textContent);
  const canvas = document.getElementById("map");
  const chart = document.getElementById("profile");
  const slider = document.getElementById("trigger");
  const chooser = document.getElementById("layer");
  const readout = document.getElementById("readout");
  const title = document.getElementById("trigger-title");
  const { width, height, coding } = film;
  const blockColumns = Math.ceil(width / coding.block);
  const palettes = {
    even: triples(film.palettes.even),
    signed: triples(film.palettes.signed),
  };
  const cache = new Map();
  // the pointer begins at the minimum film
  const [column, row] = film.minima[Number(slider.value)] ?? [width / 2, height / 2].map(Math.floor);
  const place = { column, row };
  let shown = null; // bytes of the map on screen
  let picture = null; // its colours, one canvas pixel per map pixel

  async function readMap(trigger) {
    if (!cache.has(trigger)) {
      const text = document.getElementById(`map-${film.numbers[trigger]}`).textContent.trim();
      const packed = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
      const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
      const bytes = new Uint8Array(await new Response(plain).arrayBuffer());
      if (cache.size > 12) cache.clear();
      cache.set(trigger, bytes);
    }
    return cache.get(trigger);
  }

  const pixels = width * height;
  const blocks = blockColumns * Math.ceil(height / coding.block);
  const prediction = 4 * pixels + 2 * blocks; // where its bytes begin
  const flagsAt = (n) => shown[2 * pixels + n] * 256 + shown[3 * pixels + n];
  const thicknessAt = (n) => (flagsAt(n) ? NaN : (shown[n] * 256 + shown[pixels + n]) * coding.step);

  function stdAt(column, row, which) {
    const block = Math.floor(row / coding.block) * blockColumns + Math.floor(column / coding.block);
    const code = shown[4 * pixels + which * blocks + block];
    return code ? coding.leastStd * 2 ** ((code - 1) / coding.perOctave) : NaN;
  }

  function predictedAt(n) {
    if (shown.length === prediction) return NaN;
    const count = shown[prediction + n] * 256 + shown[prediction + pixels + n];
    return count < coding.fullScale ? count * coding.step : NaN;
  }

  const valueAt = {
    thickness: (column, row) => thicknessAt(row * width + column),
    std: (column, row) => (flagsAt(row * width + column) ? NaN : stdAt(column, row, 0)),
    std_shared: (column, row) => (flagsAt(row * width + column) ? NaN : stdAt(column, row, 1)),
    predicted: (column, row) => predictedAt(row * width + column),
    difference: (column, row) =>
      thicknessAt(row * width + column) - predictedAt(row * width + column),
  };
  const flagColours = triples(film.flags.map((flag) => flag.colour.slice(1)).join(""));
  const firstFlag = (flags) => film.flags.findIndex((flag) => flags & flag.bit);
  const flagsIn = (flags) => film.flags.filter((flag) => flags & flag.bit);
  const colours = () => palettes[chooser.value === "difference" ? "signed" : "even"];

  function paint() {
    const small = new ImageData(width, height);
    const [low, high] = film.limits[chooser.value];
    const value = valueAt[chooser.value];
    const palette = colours();
    for (let n = 0; n < pixels; n++) {
      const flags = chooser.value === "predicted" ? 0 : flagsAt(n);
      const share = (value(n % width, Math.floor(n / width)) - low) / (high - low);
      const step = Math.max(0, Math.min(255, Math.floor(share * 256)));
      const colour = flags ? flagColours[firstFlag(flags)] : palette[step] || [128, 128, 128];
      small.data.set([colour[0], colour[1], colour[2], 255], 4 * n);
    }
    picture = document.createElement("canvas");
    picture.width = width;
    picture.height = height;
    picture.getContext("2d").putImageData(small, 0, 0);
  }

  // lengths are those of the page, so that text has one size at every width and resolution
  const edge = { left: 52, right: 74, top: 8, bottom: 40 };
  const frame = { left: 52, right: 12, bottom: 40 };
  let mapWidth = 1;
  let mapHeight = 1;
  const xAt = (column) => film.x[0] + column * film.x[1];
  const yAt = (row) => film.y[0] + row * film.y[1];
  const toLeft = (x) => edge.left + ((x - film.x[0]) / film.x[1] + 0.5) * (mapWidth / width);
  const toTop = (y) => edge.top + ((y - film.y[0]) / film.y[1] + 0.5) * (mapHeight / height);
  const ink = () => css("--ink");

  function prepare(surface, wide, tall) {
    const ratio = window.devicePixelRatio || 1;
    surface.style.height = `${tall}px`;
    surface.width = Math.round(wide * ratio);
    surface.height = Math.round(tall * ratio);
    const pen = surface.getContext("2d");
    pen.scale(ratio, ratio);
    return pen;
  }

  const SIZE = 13; // of text

  function drawMap() {
    const wide = Math.max(240, canvas.parentElement.clientWidth);
    mapWidth = wide - edge.left - edge.right;
    mapHeight = mapWidth * (height / width) * film.pixelAspect;
    const tall = mapHeight + edge.top + edge.bottom;
    const pen = prepare(canvas, wide, tall);
    pen.imageSmoothingEnabled = false; // a map pixel is a rectangle of one colour
    pen.drawImage(picture, edge.left, edge.top, mapWidth, mapHeight);
    pen.strokeStyle = ink();
    pen.lineWidth = 1;
    pen.strokeRect(edge.left - 0.5, edge.top - 0.5, mapWidth + 1, mapHeight + 1);
    for (const x of ticks(xAt(0), xAt(width - 1), Math.min(8, mapWidth / 40))) {
      write(pen, signed(x), toLeft(x), edge.top + mapHeight + 12, "center", SIZE);
    }
    for (const y of ticks(yAt(0), yAt(height - 1), Math.min(8, mapHeight / 25))) {
      write(pen, signed(y), edge.left - 6, toTop(y), "right", SIZE);
    }
    write(pen, film.xLabel, edge.left + mapWidth / 2, tall - 8, "center", SIZE);
    writeUpwards(pen, film.yLabel, 12, edge.top + mapHeight / 2, SIZE);

    const [x0, x1, y0, y1] = film.region;
    strokeOver(pen, () => {
      pen.rect(toLeft(x0), toTop(y0), toLeft(x1) - toLeft(x0), toTop(y1) - toTop(y0));
    });

    // chosen row and column
    for (const colour of ["#ffffff", "#000000"]) {
      const shift = colour === "#ffffff" ? 1 : 0;
      pen.strokeStyle = colour;
      pen.beginPath();
      pen.moveTo(edge.left, toTop(yAt(place.row)) + shift);
      pen.lineTo(edge.left + mapWidth, toTop(yAt(place.row)) + shift);
      pen.moveTo(toLeft(xAt(place.column)) + shift, toTop(yAt(place.row)) - 8);
      pen.lineTo(toLeft(xAt(place.column)) + shift, toTop(yAt(place.row)) + 8);
      pen.stroke();
    }

    const most = Math.min(7, mapHeight / 25);
    const bar = { left: edge.left + mapWidth + 10, top: edge.top, height: mapHeight, most, size: SIZE };
    drawBar(pen, colours(), film.limits[chooser.value], bar);
    const brief = mapHeight < 220 && chooser.value.startsWith("std");
    writeUpwards(pen, `${brief ? "s.d." : film.layers[chooser.value]} [µm]`, wide - 8, edge.top + mapHeight / 2, SIZE);
  }

  function drawProfile() {
    const name = chooser.value;
    const full = Math.max(240, chart.parentElement.clientWidth);
    const pen = prepare(chart, full, Math.min(360, 0.75 * full));
    frame.top = full > 400 ? 26 : 56; // lines above the profile
    const wide = full - frame.left - frame.right;
    const tall = Math.min(360, 0.75 * full) - frame.top - frame.bottom;

    // film and difference have the random standard deviation, drawn as a band
    const banded = name === "thickness" || name === "difference";
    const beside = name === "thickness" || name === "predicted";
    const points = [];
    for (let column = 0; column < width; column++) {
      points.push({
        x: xAt(column),
        value: valueAt[name](column, place.row),
        std: banded ? stdAt(column, place.row, 0) : 0,
        other: beside ? valueAt.predicted(column, place.row) : NaN,
      });
    }

    // the axis follows the data: neither values nor bands are cut
    const ends = name === "difference" || name.startsWith("std") ? [0] : [];
    for (const { value, std, other } of points) {
      ends.push(...[value - (std || 0), value + (std || 0), other].filter(Number.isFinite));
    }
    let [low, high] = ends.length > 1 ? [Math.min(...ends), Math.max(...ends)] : film.limits[name];
    const room = 0.04 * (high - low || 1);
    [low, high] = [low === 0 ? 0 : low - room, high + room];
    chart.dataset.low = low;
    chart.dataset.high = high;
    const left = (x) => frame.left + ((x - xAt(0)) / (xAt(width - 1) - xAt(0))) * wide;
    const top = (t) => frame.top + (1 - (t - low) / (high - low)) * tall;

    const notes = [`y = ${yAt(place.row).toFixed(2)} mm`];
    if (banded) notes.push("band: ± 1 s.d., random");
    if (beside && points.some(({ other }) => Number.isFinite(other))) notes.push("dashed: predicted");
    if (full > 400) notes.splice(0, 3, notes.join("; "));
    notes.forEach((note, n) => write(pen, note, frame.left, 11 + 16 * n, "left", SIZE));
    pen.save();
    pen.beginPath();
    pen.rect(frame.left, frame.top, wide, tall);
    pen.clip();
    pen.fillStyle = "rgba(0, 114, 178, 0.3)";
    const step = wide / width;
    for (const { x, value, std } of points) {
      if (!(std > 0) || Number.isNaN(value)) continue;
      pen.fillRect(left(x) - step / 2, top(value + std), step, top(value - std) - top(value + std));
    }

    // lines are interrupted where there is no value
    function draw(key, colour, dash) {
      pen.strokeStyle = colour;
      pen.setLineDash(dash);
      pen.lineWidth = 1.3;
      pen.beginPath();
      let drawing = false;
      for (const point of points) {
        if (Number.isNaN(point[key])) drawing = false;
        else if (drawing) pen.lineTo(left(point.x), top(point[key]));
        else {
          pen.moveTo(left(point.x), top(point[key]));
          drawing = true;
        }
      }
      pen.stroke();
    }
    if (name === "thickness") draw("other", ink(), [6, 4]);
    draw("value", name === "predicted" ? ink() : "#1a86cc", name === "predicted" ? [6, 4] : []);

    // chosen column
    pen.strokeStyle = ink();
    pen.lineWidth = 1;
    pen.setLineDash([2, 3]);
    pen.beginPath();
    pen.moveTo(left(xAt(place.column)), frame.top);
    pen.lineTo(left(xAt(place.column)), frame.top + tall);
    pen.stroke();
    pen.restore();

    // axes
    pen.strokeStyle = ink();
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(frame.left - 0.5, frame.top);
    pen.lineTo(frame.left - 0.5, frame.top + tall + 0.5);
    pen.lineTo(frame.left + wide, frame.top + tall + 0.5);
    pen.stroke();
    for (const x of ticks(xAt(0), xAt(width - 1), 7)) {
      write(pen, signed(x), left(x), frame.top + tall + 13, "center", SIZE);
    }
    for (const t of ticks(low, high, 7)) write(pen, signed(t), frame.left - 7, top(t), "right", SIZE);
    write(pen, film.xLabel, frame.left + wide / 2, frame.top + tall + 32, "center", SIZE);
    const brief = tall < 220 && name.startsWith("std");
    writeUpwards(pen, `${brief ? "s.d." : film.layers[name]} [µm]`, 12, frame.top + tall / 2, SIZE);
  }

  function showValue(column, row) {
    const n = row * width + column;
    const where = `x = ${xAt(column).toFixed(2)} mm, y = ${yAt(row).toFixed(2)} mm: `;
    const digits = (value) => signed(value.toFixed(3));
    const predicted = predictedAt(n);
    const known = Number.isFinite(predicted);
    const theory = known ? `; predicted ${digits(predicted)} µm` : "";
    const flags = flagsAt(n);
    if (flags) {
      const names = flagsIn(flags).map((flag) => flag.name);
      readout.textContent = `${where}flagged: ${names.join(", ")}${theory}`;
      return;
    }
    const less = known ? `, difference ${digits(thicknessAt(n) - predicted)} µm` : "";
    readout.textContent =
      `${where}${digits(thicknessAt(n))} µm ± ${digits(stdAt(column, row, 0))} µm random` +
      ` ± ${digits(stdAt(column, row, 1))} µm shared${theory}${less}`;
  }

  function under(event) {
    const box = canvas.getBoundingClientRect();
    const x = event.clientX - box.left - edge.left;
    const y = event.clientY - box.top - edge.top;
    const column = Math.floor((x / mapWidth) * width);
    const row = Math.floor((y / mapHeight) * height);
    return column >= 0 && column < width && row >= 0 && row < height ? { column, row } : null;
  }

  function draw() {
    drawMap();
    drawProfile();
  }

  function choose(column, row) {
    place.column = Math.max(0, Math.min(width - 1, column));
    place.row = Math.max(0, Math.min(height - 1, row));
    draw();
    showValue(place.column, place.row);
  }

  async function show(trigger) {
    slider.value = trigger;
    const bytes = await readMap(trigger);
    if (Number(slider.value) !== trigger) return; // another trigger was chosen meanwhile
    shown = bytes;
    title.textContent = film.triggers[trigger];
    slider.setAttribute("aria-valuetext", film.triggers[trigger]);
    canvas.dataset.shown = film.numbers[trigger];
    paint();
    choose(place.column, place.row);
  }

  function step(change) {
    const last = film.triggers.length - 1;
    show(Math.max(0, Math.min(last, Number(slider.value) + change)));
  }

  slider.addEventListener("input", () => show(Number(slider.value)));
  chooser.addEventListener("change", () => {
    if (!shown) return;
    paint();
    draw();
  });
  document.getElementById("previous").addEventListener("click", () => step(-1));
  document.getElementById("next").addEventListener("click", () => step(1));
  canvas.addEventListener("pointermove", (event) => {
    const at = under(event);
    if (at && shown) showValue(at.column, at.row);
  });
  canvas.addEventListener("pointerleave", () => {
    if (shown) showValue(place.column, place.row);
  });
  canvas.addEventListener("click", (event) => {
    const at = under(event);
    if (at && shown) choose(at.column, at.row);
  });
  canvas.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const move = moves[event.key];
    if (!move || !shown) return;
    event.preventDefault();
    const far = event.shiftKey ? 10 : 1;
    choose(place.column + far * move[0], place.row + far * move[1]);
  });

  // another width of the window or another theme needs another drawing
  let drawnWidth = 0;
  new ResizeObserver(() => {
    const wide = canvas.parentElement.clientWidth;
    if (shown && wide !== drawnWidth) draw();
    drawnWidth = wide;
  }).observe(canvas.parentElement);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    if (shown) draw();
  });
  if (typeof DecompressionStream === "undefined") {
    readout.textContent = "This browser cannot unpack the maps; browsers of 2023 or later can.";
  } else {
    show(Number(slider.value));
  }
})();
