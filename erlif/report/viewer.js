"use strict";
// Viewer of the thickness maps of the page: the map of one trigger, film thickness and standard
// deviations under the pointer, and the profile of the row that was clicked.
(() => {
  const film = JSON.parse(document.getElementById("film-data").textContent);
  const canvas = document.getElementById("map");
  const chart = document.getElementById("profile");
  const slider = document.getElementById("trigger");
  const readout = document.getElementById("readout");
  const title = document.getElementById("trigger-title");
  const { width, height, coding } = film;
  const blockColumns = Math.ceil(width / coding.block);
  const palette = parseColours(film.palette);
  const cache = new Map();
  const place = { column: Math.floor(width / 2), row: Math.floor(height / 2) };
  let shown = null; // bytes of the map on screen
  let picture = null; // its colours, one canvas pixel per map pixel

  function parseColours(text) {
    const colours = [];
    for (let n = 0; n < text.length; n += 6) {
      colours.push([0, 2, 4].map((k) => parseInt(text.slice(n + k, n + k + 2), 16)));
    }
    return colours;
  }

  async function readMap(trigger) {
    if (!cache.has(trigger)) {
      const text = document.getElementById(`map-${trigger}`).textContent.trim();
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
  const flagsAt = (n) => shown[2 * pixels + n];
  const countAt = (n) => shown[n] * 256 + shown[pixels + n];
  const thicknessAt = (n) => (flagsAt(n) ? NaN : countAt(n) * coding.step);

  function stdAt(column, row, which) {
    const block = Math.floor(row / coding.block) * blockColumns + Math.floor(column / coding.block);
    const code = shown[3 * pixels + which * blocks + block];
    return code ? coding.leastStd * 2 ** ((code - 1) / coding.perOctave) : NaN;
  }

  const flagsIn = (flags) => film.flags.filter((flag) => flags & flag.bit);

  function paint() {
    const small = new ImageData(width, height);
    const [low, high] = film.limits;
    for (let n = 0; n < pixels; n++) {
      const flags = flagsAt(n);
      const share = (thicknessAt(n) - low) / (high - low);
      const step = Math.max(0, Math.min(255, Math.floor(share * 256)));
      const colour = flags ? flagsIn(flags)[0].rgb : palette[step];
      small.data.set([colour[0], colour[1], colour[2], 255], 4 * n);
    }
    picture = document.createElement("canvas");
    picture.width = width;
    picture.height = height;
    picture.getContext("2d").putImageData(small, 0, 0);
  }

  const edge = { left: 52, right: 78, top: 8, bottom: 40 };
  const scale = Math.max(1, Math.round((640 / width) * 2) / 2);
  canvas.width = Math.round(width * scale) + edge.left + edge.right;
  canvas.height = Math.round(height * scale * film.pixelAspect) + edge.top + edge.bottom;
  chart.width = 480;
  chart.height = 360;
  const mapWidth = canvas.width - edge.left - edge.right;
  const mapHeight = canvas.height - edge.top - edge.bottom;
  const xAt = (column) => film.x[0] + column * film.x[1];
  const yAt = (row) => film.y[0] + row * film.y[1];
  const toLeft = (x) => edge.left + ((x - film.x[0]) / film.x[1] + 0.5) * (mapWidth / width);
  const toTop = (y) => edge.top + ((y - film.y[0]) / film.y[1] + 0.5) * (mapHeight / height);

  function ticks(low, high, most) {
    const raw = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= raw);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) {
      found.push(+(k * step).toPrecision(12));
    }
    return found;
  }

  function write(pen, text, x, y, align, baseline = "middle") {
    pen.fillStyle = "#1a1a1a";
    pen.font = "13px system-ui, 'DejaVu Sans', sans-serif";
    pen.textAlign = align;
    pen.textBaseline = baseline;
    pen.fillText(text, x, y);
  }

  function writeUpwards(pen, text, x, y) {
    pen.save();
    pen.translate(x, y);
    pen.rotate(-Math.PI / 2);
    write(pen, text, 0, 0, "center");
    pen.restore();
  }

  function drawMap() {
    const pen = canvas.getContext("2d");
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.imageSmoothingEnabled = false; // a map pixel is a rectangle of one colour
    pen.drawImage(picture, edge.left, edge.top, mapWidth, mapHeight);
    pen.strokeStyle = "#1a1a1a";
    pen.lineWidth = 1;
    pen.strokeRect(edge.left - 0.5, edge.top - 0.5, mapWidth + 1, mapHeight + 1);
    for (const x of ticks(xAt(0), xAt(width - 1), 8)) {
      write(pen, `${x}`, toLeft(x), edge.top + mapHeight + 12, "center");
    }
    for (const y of ticks(yAt(0), yAt(height - 1), 8)) {
      write(pen, `${y}`, edge.left - 6, toTop(y), "right");
    }
    write(pen, film.xLabel, edge.left + mapWidth / 2, canvas.height - 8, "center");
    writeUpwards(pen, film.yLabel, 12, edge.top + mapHeight / 2);

    // region of interest, black on white to be visible on every colour
    const [x0, x1, y0, y1] = film.region;
    pen.lineWidth = 2;
    for (const [dash, colour] of [[[], "#ffffff"], [[7, 6], "#000000"]]) {
      pen.setLineDash(dash);
      pen.strokeStyle = colour;
      pen.strokeRect(toLeft(x0), toTop(y0), toLeft(x1) - toLeft(x0), toTop(y1) - toTop(y0));
    }
    pen.setLineDash([]);
    pen.lineWidth = 1;

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

    // colour bar
    const [low, high] = film.limits;
    const left = edge.left + mapWidth + 12;
    for (let n = 0; n < 256; n++) {
      pen.fillStyle = `rgb(${palette[n].join(",")})`;
      pen.fillRect(left, edge.top + mapHeight * (1 - (n + 1) / 256), 14, mapHeight / 256 + 1);
    }
    for (const t of ticks(low, high, 7)) {
      write(pen, `${t}`, left + 19, edge.top + mapHeight * (1 - (t - low) / (high - low)), "left");
    }
    writeUpwards(pen, "film thickness [µm]", canvas.width - 9, edge.top + mapHeight / 2);
  }

  function drawProfile() {
    const pen = chart.getContext("2d");
    const frame = { left: 52, right: 12, top: 26, bottom: 40 };
    const wide = chart.width - frame.left - frame.right;
    const tall = chart.height - frame.top - frame.bottom;

    const points = [];
    for (let column = 0; column < width; column++) {
      const value = thicknessAt(place.row * width + column);
      points.push({ x: xAt(column), value, std: stdAt(column, place.row, 0) });
    }
    const [low, high] = film.limits;
    const left = (x) => frame.left + ((x - xAt(0)) / (xAt(width - 1) - xAt(0))) * wide;
    const top = (t) => frame.top + (1 - (t - low) / (high - low)) * tall;

    pen.clearRect(0, 0, chart.width, chart.height);
    const heading = `row at y = ${yAt(place.row).toFixed(2)} mm; band: ± 1 s.d., random`;
    write(pen, heading, frame.left, 11, "left");
    pen.save();
    pen.beginPath();
    pen.rect(frame.left, frame.top, wide, tall);
    pen.clip();
    pen.fillStyle = "rgba(0, 114, 178, 0.25)";
    const step = wide / width;
    for (const { x, value, std } of points) {
      if (!(value + std > 0)) continue; // false for NaN too
      pen.fillRect(left(x) - step / 2, top(value + std), step, top(value - std) - top(value + std));
    }

    // the line is interrupted at flagged pixels
    pen.strokeStyle = "#0072b2";
    pen.lineWidth = 1.2;
    pen.beginPath();
    let drawing = false;
    for (const { x, value } of points) {
      if (Number.isNaN(value)) drawing = false;
      else if (drawing) pen.lineTo(left(x), top(value));
      else {
        pen.moveTo(left(x), top(value));
        drawing = true;
      }
    }
    pen.stroke();

    // chosen column
    pen.strokeStyle = "#000000";
    pen.setLineDash([3, 3]);
    pen.beginPath();
    pen.moveTo(left(xAt(place.column)), frame.top);
    pen.lineTo(left(xAt(place.column)), frame.top + tall);
    pen.stroke();
    pen.restore();

    // axes
    pen.strokeStyle = "#1a1a1a";
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(frame.left - 0.5, frame.top);
    pen.lineTo(frame.left - 0.5, frame.top + tall + 0.5);
    pen.lineTo(frame.left + wide, frame.top + tall + 0.5);
    pen.stroke();
    for (const x of ticks(xAt(0), xAt(width - 1), 7)) {
      write(pen, `${x}`, left(x), frame.top + tall + 13, "center");
    }
    for (const t of ticks(low, high, 7)) write(pen, `${t}`, frame.left - 7, top(t), "right");
    write(pen, film.xLabel, frame.left + wide / 2, chart.height - 8, "center");
    writeUpwards(pen, "film thickness [µm]", 12, frame.top + tall / 2);
  }

  function showValue(column, row) {
    const n = row * width + column;
    const where = `x = ${xAt(column).toFixed(2)} mm, y = ${yAt(row).toFixed(2)} mm: `;
    const flags = flagsAt(n);
    if (flags) {
      const names = flagsIn(flags).map((flag) => flag.name);
      readout.textContent = `${where}flagged: ${names.join(", ")}`;
      return;
    }
    const digits = (value) => value.toFixed(3);
    readout.textContent =
      `${where}${digits(thicknessAt(n))} µm ± ${digits(stdAt(column, row, 0))} µm random` +
      ` ± ${digits(stdAt(column, row, 1))} µm shared`;
  }

  function under(event) {
    const box = canvas.getBoundingClientRect();
    const x = ((event.clientX - box.left) * canvas.width) / box.width - edge.left;
    const y = ((event.clientY - box.top) * canvas.height) / box.height - edge.top;
    const column = Math.floor((x / mapWidth) * width);
    const row = Math.floor((y / mapHeight) * height);
    return column >= 0 && column < width && row >= 0 && row < height ? { column, row } : null;
  }

  function choose(column, row) {
    place.column = Math.max(0, Math.min(width - 1, column));
    place.row = Math.max(0, Math.min(height - 1, row));
    drawMap();
    drawProfile();
    showValue(place.column, place.row);
  }

  async function show(trigger) {
    slider.value = trigger;
    const bytes = await readMap(trigger);
    if (Number(slider.value) !== trigger) return; // another trigger was chosen meanwhile
    shown = bytes;
    title.textContent = film.triggers[trigger];
    slider.setAttribute("aria-valuetext", film.triggers[trigger]);
    paint();
    choose(place.column, place.row);
  }

  function step(change) {
    const last = film.triggers.length - 1;
    show(Math.max(0, Math.min(last, Number(slider.value) + change)));
  }

  slider.addEventListener("input", () => show(Number(slider.value)));
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
  if (typeof DecompressionStream === "undefined") {
    readout.textContent = "This browser cannot unpack the maps; browsers of 2023 or later can.";
  } else {
    show(Number(slider.value));
  }
})();
