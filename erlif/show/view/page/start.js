// The page of `erlif start`: folders, images, settings and their changes, and the way to the film.
import { byId, element, report } from "./draw.js";
import { showForm, showLines } from "./form.js";
import { makeFrames, showFrames } from "./frames.js";
import { get, post } from "./server.js";

const PACE = 400; // time between two looks at the progress, in milliseconds
const NAMES = ["fixture", "run"];

let state = null; // what the server has sent last
let shown = ""; // "fixture" or "run"
let picked = { name: "", folder: "" }; // in the dialog

const guarded = (action) => async (...values) => {
  try {
    report("");
    return await action(...values);
  } catch (error) {
    report(error.message, true);
  }
};

const read = async (name) => (await get(name)).json();

function show(found) {
  state = found;
  const open = NAMES.filter((name) => state.files[name]);
  NAMES.forEach(showCard);
  if (!open.includes(shown)) shown = open[0] ?? "";
  byId("opened").hidden = !shown;
  for (const input of document.querySelectorAll("input[name=shown]")) {
    input.disabled = !state.files[input.value];
    input.checked = input.value === shown;
    const gaps = state.files[input.value]?.fields.filter(({ gap }) => gap).length;
    input.parentElement.querySelector("span").textContent = gaps ? `, ${gaps} values asked for` : "";
  }
  showChanges();
  showWork();
  if (!shown) return;
  showForm(shown, state.files[shown], show);
  showFrames(shown, state.files[shown]);
}

// folders

function showCard(name) {
  const card = byId(`card-${name}`);
  const part = (kind) => card.querySelector(kind);
  const file = state.files[name];
  const own = state.root.split(/[\\/]/).at(-1);
  part(".folder").textContent = !file ? "not chosen" : file.folder === "." ? own : file.folder;
  part(".anew").hidden = !file;
  part(".take").hidden = file || state.suggested[name] === undefined;
  part(".take").textContent = `Take ${state.suggested[name] || "this folder"}`;
  if (name === "run") showKind(file);
  part("details").hidden = !file?.notes.length;
  const odd = file?.notes.filter(({ level }) => level !== "note").length;
  part("summary").textContent = `What was found${odd ? `, ${odd} to look at` : ""}`;
  part("ul").replaceChildren(...(file?.notes ?? []).map(({ subject, text, level }) =>
    element(level === "note" ? "li" : "li.bad", `${subject}: ${text}`)));
}

// another tribometer asks for other values
function showKind(file) {
  const kind = file && (file.fields.find(({ place }) => place === "mechanism.kind")?.value || "static");
  byId("kind").dataset.now = kind ?? "";
  if (kind) byId("kind").value = kind;
  nameDraft();
}

function nameDraft() {
  const { value, dataset } = byId("kind");
  byId("card-run").querySelector(".anew").textContent =
    value === dataset.now ? "Draft anew" : `Draft anew for ${value}`;
}

async function list(folder) {
  byId("picker-refusal").textContent = "";
  try {
    const found = await post("folders", { folder });
    picked.folder = folder;
    const holds = found.settings.length ? `, ${found.settings.join(" and ")} among them` : "";
    byId("picker-path").textContent = `${folder || state.root}: ${found.files} files${holds}`;
    const up = folder ? [["↑ one folder up", folder.split("/").slice(0, -1).join("/")]] : [];
    const down = found.folders.map((one) => [one, folder ? `${folder}/${one}` : one]);
    byId("picker-folders").replaceChildren(...[...up, ...down].map(([text, place]) => {
      const button = element("button", text);
      button.type = "button";
      button.addEventListener("click", () => list(place));
      return element("li", button);
    }));
  } catch (error) {
    byId("picker-refusal").textContent = error.message;
  }
}

async function pick(name) {
  picked = { name, folder: "" };
  byId("picker-title").textContent = `Folder of the ${name}`;
  byId("picker").showModal();
  byId("picker-take").focus();
  await list(state.files[name]?.folder.replace(/^\.$/, "") ?? state.suggested[name] ?? "");
}

async function open(name, folder, anew = false) {
  report("Reading the files …");
  const found = await post("open", { name, folder, kind: byId("kind").value, anew });
  shown = name;
  report("");
  show(found);
}

// changes

function showChanges() {
  const last = state.changes.at(-1);
  byId("undo").disabled = !last;
  byId("undo").textContent = last ? `Undo ${last.file}: ${last.title}` : "Undo";
  byId("changes").replaceChildren(...state.changes.map(({ file, title, lines }, n) => {
    const pre = element("pre");
    showLines(pre, lines);
    const details = element("details", element("summary", `${file}: ${title}`), pre);
    details.open = n === state.changes.length - 1 && lines.length < 4000;
    return element("li", details);
  }).reverse());
}

// work

function showWork() {
  const { work, files } = state;
  byId("progress").hidden = !work.running;
  byId("cancel").hidden = !work.running;
  for (const button of document.querySelectorAll(".task")) {
    button.disabled = work.running || !files[button.dataset.name];
  }
  if (work.running) {
    const bar = byId("progress").querySelector("progress");
    if (work.total) [bar.max, bar.value] = [work.total, work.done];
    else bar.removeAttribute("value");
    byId("progress").querySelector("span").textContent =
      `${work.name}: ${work.step || "begins"}${work.total ? ` ${work.done} of ${work.total}` : ""}`;
  }
  byId("notes").replaceChildren(...work.notes.map(({ level, text }) =>
    element(`li.${level}`, text)));
  showCurve(work.name === "calibrate" && !work.running && !work.failed);
  byId("film").hidden = !work.film || work.running;
  byId("film").querySelector("span").textContent = work.film ?? "";
  document.body.dataset.work = work.running ? "running" : work.failed ? "failed" : work.name;
}

// the figure of a calibration, once it is made
async function showCurve(made) {
  const image = byId("curve");
  if (image.hidden === !made) return;
  image.hidden = !made;
  if (made) image.src = URL.createObjectURL(await (await get("curve")).blob());
}

async function follow() {
  while (state.work.running) {
    await new Promise((done) => { setTimeout(done, PACE); });
    state.work = await read("work");
    showWork();
  }
  show(await read("state"));
}

const begin = guarded(async ({ task, name }) => {
  show(await post("start", { task, name, skip: byId("skip").checked }));
  await follow();
});

function connect() {
  for (const name of NAMES) {
    const card = byId(`card-${name}`);
    card.querySelector(".take").addEventListener("click", guarded(() =>
      open(name, state.suggested[name])));
    card.querySelector(".choose").addEventListener("click", guarded(() => pick(name)));
    card.querySelector(".anew").addEventListener("click", guarded(() =>
      open(name, state.files[name].folder, true)));
  }
  byId("kind").addEventListener("change", nameDraft);
  byId("picker-take").addEventListener("click", guarded(async () => {
    byId("picker").close();
    await open(picked.name, picked.folder);
  }));
  byId("picker-cancel").addEventListener("click", () => byId("picker").close());
  byId("shown").addEventListener("change", (event) => {
    shown = event.target.value;
    show(state);
  });
  byId("exchange").addEventListener("click", guarded(async () =>
    show(await post("exchange", { name: shown }))));
  byId("undo").addEventListener("click", guarded(async () => show(await post("undo", {}))));
  byId("cancel").addEventListener("click", guarded(async () => {
    await post("cancel", {});
    byId("progress").querySelector("span").textContent = "It is cancelled at its next step …";
  }));
  for (const button of document.querySelectorAll(".task")) {
    button.addEventListener("click", () => begin(button.dataset));
  }
}

await guarded(async () => {
  const first = await read("state");
  byId("root").textContent = first.root;
  makeFrames(first, show);
  connect();
  show(first);
  document.body.dataset.ready = "";
  if (state.work.running) await follow();
})();
