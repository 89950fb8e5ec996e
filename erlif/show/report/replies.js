// What the viewer asks for, from the data of the report around it.
const held = (name) => parent.document.getElementById(name).textContent;
const { coding, cycle, texts, limits, ...films } = JSON.parse(held("film-data"));
const [{ width, height, numbers, x: [x0, dx], y: [y0, dy] }] = films.films;
const pixels = width * height;
const acrossBlocks = Math.ceil(width / coding.block);
const blocks = acrossBlocks * Math.ceil(height / coding.block);
const theoryAt = 4 * pixels + 2 * blocks; // where the bytes of the prediction begin
const MOST = 12; // maps that are kept unpacked
const unpacked = new Map();

async function readMap(trigger) {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("This browser cannot unpack the maps; browsers of 2023 or later can.");
  }
  if (!unpacked.has(trigger)) {
    const bytes = Uint8Array.from(atob(held(`map-${numbers[trigger]}`)), (c) => c.charCodeAt(0));
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    if (unpacked.size > MOST) unpacked.clear();
    unpacked.set(trigger, new Uint8Array(await new Response(plain).arrayBuffer()));
  }
  return unpacked.get(trigger);
}

// values of a pixel of an unpacked map, NaN where there is none
const countAt = (map, n, from = 0) => map[from + n] * 256 + map[from + pixels + n];
const flagsAt = (map, n) => countAt(map, n, 2 * pixels);

function stdAt(map, n, which) {
  const block = Math.floor(Math.floor(n / width) / coding.block) * acrossBlocks
    + Math.floor((n % width) / coding.block);
  const code = flagsAt(map, n) ? 0 : map[4 * pixels + which * blocks + block];
  return code ? coding.leastStd * 2 ** ((code - 1) / coding.perOctave) : NaN;
}

const LAYERS = {
  thickness: (map, n) => (flagsAt(map, n) ? NaN : countAt(map, n) * coding.step),
  thickness_std: (map, n) => stdAt(map, n, 0),
  thickness_std_shared: (map, n) => stdAt(map, n, 1),
  predicted: (map, n) => {
    const count = countAt(map, n, theoryAt);
    return count < coding.fullScale ? count * coding.step : NaN; // also where there are no bytes
  },
  residual: (map, n) => LAYERS.thickness(map, n) - LAYERS.predicted(map, n),
};
const known = (value) => (Number.isFinite(value) ? value : null);

const ask = {
  films: async () => ({ ...films, limits }),
  cycle: async () => cycle,

  async map({ trigger, layer }) {
    const map = await readMap(trigger);
    const places = Array.from({ length: pixels }, (_, n) => n);
    const reasons = Uint16Array.from(places, (n) => flagsAt(map, n));
    const values = Float32Array.from(places, (n) => LAYERS[layer](map, n));
    return {
      text: texts[trigger], window: [0, 0, width, height], step: 1, shape: [height, width],
      values, flags: layer === "predicted" ? new Uint16Array(pixels) : reasons,
      shares: films.flags.map(({ bit }) => reasons.filter((bits) => bits & bit).length / pixels),
    };
  },

  // the nearest pixels along a line
  async profile({ trigger, layer, line }) {
    const map = await readMap(trigger);
    const [left, top, right, bottom] = line.split(",").map(Number);
    const count = Math.ceil(Math.hypot((right - left) / dx, (bottom - top) / dy)) + 1;
    const found = { position: [], value: [], std: [], predicted: [] };
    for (let k = 0; k < count; k++) {
      const share = count > 1 ? k / (count - 1) : 0;
      const column = Math.round((left + share * (right - left) - x0) / dx);
      const row = Math.round((top + share * (bottom - top) - y0) / dy);
      const inside = column >= 0 && column < width && row >= 0 && row < height;
      const read = (name) => known(inside ? LAYERS[name](map, row * width + column) : NaN);
      found.position.push(share * Math.hypot(right - left, bottom - top));
      found.value.push(read(layer));
      found.std.push(layer === "thickness" ? read("thickness_std") : null);
      found.predicted.push(layer === "thickness" ? read("predicted") : null);
    }
    return found.predicted.some((one) => one !== null) ? found : { ...found, predicted: null };
  },

  async pixel({ trigger, layer, place }) {
    const map = await readMap(trigger);
    const [x, y] = place.split(",").map(Number);
    const column = Math.min(Math.max(Math.round((x - x0) / dx), 0), width - 1);
    const row = Math.min(Math.max(Math.round((y - y0) / dy), 0), height - 1);
    const read = (name) => known(LAYERS[name](map, row * width + column));
    const { unit } = films.layers.find(({ name }) => name === layer);
    const found = { x, y, column, row, unit, value: read(layer) };
    if (layer !== "predicted") found.flags = flagsAt(map, row * width + column);
    if (layer !== "thickness") return found;
    return { ...found, std: read("thickness_std"), std_shared: read("thickness_std_shared"),
      predicted: read("predicted") };
  },
};

document.body.classList.add("inside");
new ResizeObserver(() => {
  frameElement.style.height = `${document.documentElement.offsetHeight}px`;
}).observe(document.body);
