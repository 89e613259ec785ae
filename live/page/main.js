// Puts the page together: connection -> model -> panels, thirty pictures a second.

import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { Details } from "./details.js";
import { Episodes } from "./episodes.js";
import { Graph } from "./graph.js";
import { exposeHook } from "./hook.js";
import { LearningPanel } from "./learning.js";
import { Model } from "./model.js";
import { onTheme, startTheme, switchTheme } from "./palette.js";
import { Pictures } from "./pictures.js";
import { Status } from "./status.js";
import { setText } from "./text.js";
import { TimePanel } from "./timepanel.js";
import { Trajectory } from "./trajectory.js";
import { WorldPanel } from "./world.js";

const PICTURE_MS = 1000 / 30;
const TEXT_MS = 100;  // numbers that change faster cannot be read
const RETRY_MS = 500;
const MOST_ASKED = 5;
const MORE_READS = 4;

startTheme();
const model = new Model();
const trajectory = new Trajectory();
let dirty = true;  // something has changed since the last picture
const touch = () => { dirty = true; };

const connection = new Connection(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/${location.search}`, {
  opened() {
    document.body.dataset.connection = "connected";
    describe();
  },
  closed() {
    document.body.dataset.connection = "lost";
    if (connection.lostAt) {
      model.interrupt();
    }
    touch();
  },
  info: begin,
  advertised(channels) {
    channels.forEach((channel) => model.classify(channel));
    subscribe();
  },
  unadvertised: touch,
  unsubscribed(channel) {
    if (channel.output) {
      model.interrupt([channel.output]);
    }
  },
  data(channel, seconds, bytes) {
    model.receive(channel, seconds, bytes);
    touch();
  },
  time(seconds) {
    if (model.timeline.advance(seconds)) {
      touch();
    }
  },
  parameters(list) {
    list.forEach(({ name, value }) => model.parameters.set(name, value));
    controls.parameters(list);
    touch();
  },
  notice: (level, text) => status.notice(level, text),
});

model.running = () => connection.state === "connected" && !model.summary().ended;
const timePanel = new TimePanel(model, subscribe);
const world = new WorldPanel(model, trajectory, touch);
const pictures = new Pictures(model);
const learning = new LearningPanel(model, new Episodes(), touch);
const details = new Details(model);
const graph = new Graph(model, (kind, item) => details.open(kind, item));
const status = new Status(model, connection);
const controls = new Controls(model, connection);
const frames = [];  // times of the last pictures

/// The server has told which run it serves, "RUN-PART". Another run begins with an empty page, another part of a
/// recording without data.
function begin(info) {
  const same = model.session === undefined || model.session === info.sessionId;
  const [run, before] = [info.sessionId, model.session].map((session) => session?.split("-")[0]);
  if (!same && run === before) {
    [model, timePanel].forEach((each) => each.rewind());
    world.layer = null;
  } else if (!same) {
    model.reset();
    [trajectory, world, timePanel, pictures, learning, controls].forEach((each) => each.reset());
    details.close();
    status.showResults(null);
    ended = false;
    asked = 0;
    describe();
  }
  model.session = info.sessionId;
  const { experiment, sync, recording } = info.metadata ?? {};
  model.recording = recording === "yes";
  document.getElementById("experiment").textContent = experiment || info.name || "Spikeloop";
  document.getElementById("mode").textContent = sync ?? model.resolved?.sync ?? "";
  document.title = `${experiment || "run"} – Spikeloop`;
  if (same) {
    controls.connected();
  }
}

/// Description of the run and its world; asked again until the run has written them.
let describing = null, asked = 0;
async function describe() {
  clearTimeout(describing);
  const resolved = await getJson("/run/resolved.json");
  const found = resolved?.robot ? await getJson("/run/world.json") : null;
  if (resolved || found) {
    model.describe(resolved ?? model.resolved, found ?? model.world);
    setText(document.getElementById("mode"), model.resolved?.sync ?? "");
    for (const channel of connection.channels.values()) {
      model.classify(channel);
    }
    subscribe();
    touch();
  }
  asked += 1;  // a robot of one's own has no world
  const worldComes = model.resolved?.robot && !model.world && asked < MOST_ASKED;
  const wait = !model.resolved ? RETRY_MS : worldComes ? 4 * RETRY_MS : 0;
  if (wait && connection.state === "connected") {
    describing = setTimeout(describe, wait);
  }
}

async function getJson(path) {
  try {
    const answer = await fetch(path, { cache: "no-store" });
    return answer.ok ? await answer.json() : null;
  } catch {
    return null;
  }
}

/// Only what is shown is asked for; of several channels of one topic of ROS the first.
function subscribe() {
  const first = new Map();
  for (const channel of connection.channels.values()) {
    if (!first.has(channel.topic)) {
      first.set(channel.topic, channel);
    }
  }
  const commandsShown = new Set(timePanel.wanted.filter((row) => row.command).map((row) => row.output.node));
  const camera = [...connection.channels.values()].find((each) => each.role === "picture");
  connection.update((channel) => {
    switch (channel.role) {
      case "status": case "view": case "latency": case "weights": return true;
      case "output": return timePanel.shows(channel.output);
      case "scan": return first.get(channel.topic) === channel;
      case "picture": return channel === camera;
      case "sent": return first.get(channel.topic) === channel &&
        [...model.sent].some(([node, sent]) => sent.topic === channel.topic && commandsShown.has(node));
      default: return false;
    }
  });
  touch();
}

/// Whether a file may have new rows: not while time stands still (but a few times more, for the last rows), or of a run
/// that does not write it.
function growth(writes) {
  let time = -1, more = 0;
  return () => {
    if (connection.state !== "connected" || !writes(model.resolved ?? {})) {
      return false;
    }
    more = time === model.timeline.newest ? more - 1 : MORE_READS;
    time = model.timeline.newest;
    return more > 0;
  };
}

let ended = false;
async function noteEnd() {
  if (!ended && model.summary().ended) {
    ended = true;
    for (let attempt = 0; attempt < 6; ++attempt) {  // it is written at the very end
      const results = await getJson("/run/summary.json");
      if (results) {
        status.showResults(results);
        return;
      }
      await new Promise((resolve) => { setTimeout(resolve, RETRY_MS); });
    }
  }
}

let textAt = 0;
function frame(now) {
  requestAnimationFrame(frame);
  if (now - (frames.at(-1) ?? 0) < PICTURE_MS - 4) {
    return;
  }
  if (now - textAt > TEXT_MS) {
    textAt = now;
    drawTexts();
  }
  if (trajectory.count !== world.drawnRows) {
    touch();
  }
  if (!dirty) {
    return;
  }
  dirty = false;
  frames.push(now);
  while (frames[0] < now - 1000) {
    frames.shift();
  }
  timePanel.update();
  timePanel.draw();
  if (!world.panel.hidden) {
    world.draw();
  }
  pictures.draw();
  learning.draw();
}

function drawTexts() {
  const shown = world.available || Boolean(model.picture);
  world.panel.hidden = !shown;
  world.panel.dataset.only = world.available ? "" : "picture";
  setText(world.title, world.available ? "World" : "Camera");
  document.getElementById("panels").dataset.world = shown ? "yes" : "no";
  status.draw();
  controls.draw();
  learning.update();
  graph.update();
  graph.draw();
  noteEnd();
}

/// A panel as large as the page, and back.
for (const button of document.querySelectorAll(".enlarge")) {
  button.addEventListener("click", () => {
    const panels = document.getElementById("panels"), { panel } = button.dataset;
    if (panels.dataset.big === panel) {
      delete panels.dataset.big;
    } else {
      panels.dataset.big = panel;
    }
    touch();
  });
}
document.getElementById("theme").addEventListener("click", switchTheme);
onTheme(touch);
model.timeline.onChange(touch);
addEventListener("resize", touch);
trajectory.table.start(growth(({ robot, ros = "none" }) => robot || ros !== "none"));
learning.episodes.table.start(growth(({ episodes, robot }) => episodes || robot?.environment));
exposeHook({ model, connection, timePanel, world, pictures, learning, status, controls, trajectory, frames });
requestAnimationFrame(frame);
connection.start();
