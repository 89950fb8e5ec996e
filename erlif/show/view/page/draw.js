// What the pages share: elements, and of maps the colours, ticks, text and the colour bar.
export const byId = (id) => document.getElementById(id);

// an element, of the class behind the point where the kind has one
export function element(kind, ...parts) {
  const [tag, look] = kind.split(".");
  const made = document.createElement(tag);
  if (look) made.className = look;
  made.append(...parts);
  return made;
}

export function report(text, bad = false) {
  byId("status").textContent = text;
  byId("status").classList.toggle("bad", bad);
}

// colours of flags with a text each; one without a text is left out
export function showKey(flags, texts) {
  byId("key").replaceChildren(...flags.flatMap((flag, n) => {
    const swatch = element("span.swatch");
    swatch.style.background = flag.colour;
    return texts[n] ? [element("li", swatch, texts[n])] : [];
  }));
}

// One call at a time; of those that come meanwhile, the last one is made after it, also after a
// failure, which is then that of an older call.
export function latest(action) {
  let busy = null;
  let next = null;
  const run = async () => {
    try {
      while (next) {
        const values = next;
        next = null;
        try {
          await action(...values);
        } catch (error) {
          if (!next) throw error;
        }
      }
    } finally {
      busy = null; // at once: no call may join a loop that has ended
    }
  };
  return (...values) => {
    next = values;
    busy ??= run();
    return busy;
  };
}

export const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name);
export const signed = (value) => `${value}`.replace("-", "\u2212");

export function ticks(low, high, most) {
  const raw = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= raw * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) {
    found.push(+(k * step).toPrecision(10));
  }
  return found;
}

// red, green and blue of colours that are six hexadecimal digits each
export function triples(text) {
  const found = [];
  for (let n = 0; n < text.length; n += 6) {
    found.push([0, 2, 4].map((k) => parseInt(text.slice(n + k, n + k + 2), 16)));
  }
  return found;
}

const fontOf = (size) => `${size}px system-ui, "DejaVu Sans", sans-serif`;

export function lengthOf(pen, text, size = 12) {
  pen.font = fontOf(size);
  return pen.measureText(text).width;
}

export function write(pen, text, x, y, align, size = 12) {
  pen.fillStyle = css("--ink");
  pen.font = fontOf(size);
  pen.textAlign = align;
  pen.textBaseline = "middle";
  pen.fillText(text, x, y);
}

export function writeUpwards(pen, text, x, y, size = 12) {
  pen.save();
  pen.translate(x, y);
  pen.rotate(-Math.PI / 2);
  write(pen, text, 0, 0, "center", size);
  pen.restore();
}

// black dashes on white are visible on every colour
export function strokeOver(pen, path) {
  for (const [dash, colour] of [[[], "#ffffff"], [[6, 5], "#000000"]]) {
    pen.setLineDash(dash);
    pen.strokeStyle = colour;
    pen.lineWidth = 2;
    pen.beginPath();
    path();
    pen.stroke();
  }
  pen.setLineDash([]);
  pen.lineWidth = 1;
}

// a circle around a point, visible on every colour
export function circle(pen, [x, y], radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 7);
  for (const [wide, colour] of [[4, "#ffffff"], [2, "#000000"]]) {
    pen.lineWidth = wide;
    pen.strokeStyle = colour;
    pen.stroke();
  }
}

// a bar of 256 colours beside a map, with the values at its ticks
export function drawBar(pen, colours, [low, high], { left, top, height, most, size = 12 }) {
  for (let n = 0; n < 256; n++) {
    pen.fillStyle = `rgb(${colours[n].join(",")})`;
    pen.fillRect(left, top + height * (1 - (n + 1) / 256), 13, height / 256 + 1);
  }
  for (const value of ticks(low, high, most)) {
    const place = top + height * (1 - (value - low) / (high - low));
    write(pen, signed(value), left + 17, place, "left", size);
  }
}
