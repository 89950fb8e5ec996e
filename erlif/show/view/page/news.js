// What the pages of `erlif watch` share: news from the server, the age of the picture, faults.
import { byId, element } from "./draw.js";
import { get } from "./server.js";

export const fixed = (value, digits) =>
  (value === null || value === undefined ? "–" : value.toFixed(digits).replace("-", "−"));
export const percent = (value) => (value === null ? "–" : `${fixed(100 * value, 1)} %`);

const PACE = 500; // time between two requests for news, in milliseconds
const OLD = 2; // age of the picture that is marked, in seconds
let clock = 0; // of the server less that of this page, in seconds

export const pause = () => new Promise((done) => { setTimeout(done, PACE); });

// asks for news again and again, and hands them to `show`, until the recording ends
export async function follow(known, show) {
  let version = -1;
  for (;;) {
    let news;
    try {
      news = await (await get("news", { version, ...known() })).json();
    } catch (error) {
      state(error.message, true);
      return;
    }
    clock = news.now - Date.now() / 1000;
    version = news.version;
    show(news);
    if (news.status) state(news.status, news.failed);
    if (news.closed) return;
    await pause();
  }
}

function state(text, bad) {
  byId("status").textContent = text;
  byId("status").className = bad ? "bad" : "stated";
}

export function showAge(news) {
  const age = news.newest ? Date.now() / 1000 + clock - news.newest.time : null;
  byId("age").textContent = age === null ? "No pair yet"
    : `Picture ${fixed(Math.max(age, 0), 1)} s old`;
  byId("age").classList.toggle("old", age !== null && age > OLD);
}

export const listIn = (id, texts) =>
  byId(id).replaceChildren(...texts.map((text) => element("li", text)));

export const showFaults = (news) => listIn("faults", news.faults);
