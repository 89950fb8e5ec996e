// Settings as a form: each key with its unit and its meaning, checked while it is typed.
import { byId, element, latest } from "./draw.js";
import { post } from "./server.js";

// lines of a change, with what is added and removed in colours
export function showLines(place, lines) {
  const kinds = { "+": "span.added", "-": "span.removed" };
  place.replaceChildren(...lines.split("\n").map((line) =>
    element(kinds[line[0]] ?? "span", `${line}\n`)));
}

// values that can be drawn on the frame, by the tool
const DRAWN = { "optics.pixel_pitch": "scale", "fixture.origin": "origin" };

class Field {
  constructor(name, about, changed) {
    [this.name, this.place, this.changed] = [name, about.place, changed];
    const [key, ...tables] = about.place.split(".").reverse();
    this.input = about.choices.length ? element("select",
      ...["", ...about.choices].map((choice) => element("option", choice))) : element("input");
    this.input.id = `${name}.${about.place}`;
    this.input.autocomplete = "off";
    this.input.spellcheck = false;
    const table = element("span.table",
      tables.length ? `[${tables.reverse().join(".")}]` : "top");
    const label = element("label", key, table);
    label.htmlFor = this.input.id;
    this.other = element("button.other");
    this.without = element("button", "Leave out");
    this.drawn = element("button", "Take it from the frame");
    for (const button of [this.other, this.without, this.drawn]) button.type = "button";
    this.drawn.hidden = !DRAWN[about.place];
    this.unit = element("span");
    const value = element("div.value", this.input, this.unit, this.drawn, this.other, this.without);
    this.fault = element("p.bad");
    this.fault.id = `${this.input.id}.fault`;
    this.input.setAttribute("aria-describedby", this.fault.id);
    this.remark = element("p");
    this.lines = element("pre");
    const [form, example] = about.expected.split(", for example ");
    this.example = example ? `for example ${example.replaceAll('"', "")}` : "";
    this.row = element("div", label, value, this.fault, this.remark,
      element("p", /\d|^(pair|list|interval)/.test(form)
        ? `${about.meaning} ${form[0].toUpperCase()}${form.slice(1)}.` : about.meaning), this.lines);
    this.row.dataset.place = about.place;
    this.listen();
  }

  listen() {
    const attempt = latest(async () => {
      try {
        const { lines, faults } = await post("try", this.change());
        this.fault.textContent = faults.join("\n");
        showLines(this.lines, lines);
      } catch (error) {
        this.fault.textContent = error.message;
      }
    });
    this.input.addEventListener("input", () => {
      this.typing = true;
      attempt();
    });
    this.input.addEventListener("change", () => this.write(this.input.value));
    this.other.addEventListener("click", () => this.write(this.about.other));
    this.without.addEventListener("click", () => this.write(""));
    this.drawn.addEventListener("click", () => {
      document.querySelector(`input[value=${DRAWN[this.place]}]`).click();
      byId("panel-1").querySelector("canvas").focus();
    });
  }

  change(value = this.input.value) {
    return { name: this.name, values: { [this.place]: value } };
  }

  async write(value) {
    this.typing = false;
    try {
      const state = await post("change", this.change(value));
      this.lines.replaceChildren();
      this.changed(state);
    } catch (error) {
      this.fault.textContent = error.message;
    }
  }

  show(about, other) {
    this.about = about;
    if (!this.typing) this.input.value = about.value;
    this.row.className = `field${about.gap ? " gap" : ""}`;
    this.unit.textContent = about.value ? "" : about.unit;
    this.input.placeholder = about.gap ? this.example : "";
    this.fault.textContent = about.fault;
    this.remark.textContent = about.remark ? `→ ${about.remark}` : "";
    this.other.hidden = !about.other;
    this.other.textContent = `${about.other}, as in ${other}`;
    this.without.hidden = !about.gap || about.required;
  }
}

const forms = {};

// shows the settings of "run" or "fixture"; `changed` receives the state after a change
export function showForm(name, file, changed) {
  const fields = forms[name] ??= new Map();
  const [asked, others] = [[], []];
  for (const about of file.fields) {
    if (!fields.has(about.place)) fields.set(about.place, new Field(name, about, changed));
    fields.get(about.place).show(about, name === "run" ? "fixture.toml" : "run.toml");
    (about.asked ? asked : others).push(fields.get(about.place).row);
  }
  place(byId("asked"), asked);
  place(byId("others"), others);
  const gaps = file.fields.filter(({ gap }) => gap).length;
  byId("file").textContent = file.file;
  byId("left").textContent = gaps ? `${gaps} ${gaps === 1 ? "value is" : "values are"} asked for.`
    : "Nothing is asked for any more.";
  byId("text").textContent = file.text;
  byId("faults").replaceChildren(...file.faults.map((text) => element("li", text)));
}

// rows that stand there already keep the focus
function place(box, rows) {
  const there = [...box.children];
  if (rows.length !== there.length || rows.some((row, n) => row !== there[n])) {
    const focus = document.activeElement;
    box.replaceChildren(...rows);
    if (box.contains(focus)) focus.focus();
  }
}
