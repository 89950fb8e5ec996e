// What the server of the page sends; within a report replies.js stands in its place.
export async function get(name, values = {}) {
  return reach(`${name}?${new URLSearchParams(values)}`);
}

async function reach(address, options) {
  const response = await fetch(address, options).catch(() => {
    throw new Error("The server of this page does not run any more. Start its command again.");
  });
  if (!response.ok) throw new Error(await refusal(response));
  return response;
}

async function refusal(response) {
  const text = await response.text();
  try {
    return JSON.parse(text).message;
  } catch {
    return text;
  }
}

// sends values as JSON, and returns the reply
export async function post(name, values) {
  const response = await reach(name, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(values),
  });
  return response.json();
}

const read = (name) => async (values) => (await get(name, values)).json();

export const ask = {
  ...Object.fromEntries(["films", "cycle", "profile", "region", "pixel"].map((name) =>
    [name, read(name)])),
  map: async (values) => (await get("map", values)).arrayBuffer(),
  export: async (values) => (await get("export", values)).blob(),
  settings: (values) => post("settings", values),
};
