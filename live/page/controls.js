// STOP, pause, step, speed and sliders. What they show comes from the server's answers, never from a click.

import { setText, short } from "./text.js";

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10];
const ANSWER_MS = 1500;  // after which a missing answer is told
const HOLD_MS = 400;  // after a slider was moved, answers do not move it back

/// Whether a key that was pressed may be a shortcut: alone, once, and not in a field that takes letters.
export function isShortcut(event) {
  return !(event.ctrlKey || event.altKey || event.metaKey || event.repeat ||
           event.target.closest?.("input:not([type=range]), select"));
}

export class Controls {
  constructor(model, connection) {
    this.model = model;
    this.connection = connection;
    this.stop = document.getElementById("stop");
    this.release = document.getElementById("release");
    this.pause = document.getElementById("pause");
    this.step = document.getElementById("step");
    this.speed = document.getElementById("speed");
    this.sliders = new Map();
    this.asked = null;  // when STOP was asked for, until the server has answered
    this.stop.addEventListener("click", () => this.press());
    this.release.addEventListener("click", () => connection.setParameter("run.stop", false));
    this.pause.addEventListener("click", () => this.togglePause());
    this.step.addEventListener("click", () => this.advance());
    this.speed.addEventListener("change", () => connection.setParameter("run.speed", Number(this.speed.value)));
    document.addEventListener("keydown", (event) => this.key(event), { capture: true });
  }

  /// Escape only ever presses STOP; releasing takes a click, so that no second press undoes the first one.
  key(event) {
    if (event.key === "Escape") {
      event.preventDefault();
      this.press();
      return;
    }
    if (!isShortcut(event)) {
      return;
    }
    if (event.key.toLowerCase() === "p" && !this.pause.hidden) {
      this.togglePause();
    } else if (event.key.toLowerCase() === "n" && !this.step.hidden && !this.step.disabled) {
      this.advance();
    }
  }

  press() {
    if (!this.model.summary().ended) {  // else it would stop the next run at this address
      this.asked = performance.now();
      this.ask();
      this.draw();
    }
  }

  ask() {
    this.askedLast = performance.now();
    this.sent = this.connection.setParameter("run.stop", true);
  }

  /// A STOP without an answer is sent again as soon as there is a connection: it may have been lost on the way.
  connected() {
    if (this.asked !== null) {
      this.ask();
    }
  }

  parameters(list) {
    list.forEach(({ name, value }) => {
      if (name === "run.stop" && value === true) {
        this.asked = null;
      }
    });
  }

  togglePause() {
    this.connection.setParameter("run.pause", this.model.parameters.get("run.pause") !== true);
  }

  advance() {
    // Presses in quick succession come before the answers: they are counted here.
    const known = this.model.parameters.get("run.step") ?? 0;
    this.steps = Math.max(known, this.steps ?? 0) + 1;
    this.connection.setParameter("run.step", this.steps);
  }

  reset() {
    this.steps = 0;
    this.asked = null;
    this.sliders.clear();
    document.getElementById("sliders-body").replaceChildren();
  }

  draw() {
    const { parameters } = this.model;
    const offline = this.connection.state !== "connected";
    this.drawStop(parameters, offline);
    const paused = parameters.get("run.pause") === true;
    this.pause.hidden = !parameters.has("run.pause");
    this.pause.disabled = offline;
    this.pause.setAttribute("aria-pressed", String(paused));
    setText(this.pause.firstElementChild, paused ? "Resume" : "Pause");
    this.step.hidden = !parameters.has("run.step") || !parameters.has("run.pause");
    this.step.disabled = offline || !paused;
    document.getElementById("speed-cell").hidden = !parameters.has("run.speed");
    this.drawSpeed(parameters.get("run.speed"), offline);
    this.drawSliders(offline);
  }

  drawStop(parameters, offline) {
    const known = parameters.has("run.stop");
    this.stop.hidden = !known;
    const pressed = parameters.get("run.stop") === true;
    this.release.hidden = !pressed || offline;
    let [state, text] = pressed ? ["pressed", "pressed"] : ["released", "released"];
    if (this.asked !== null && !pressed) {
      if (!offline && performance.now() - this.askedLast > ANSWER_MS) {
        this.ask();
      }
      [state, text] = ["sending", performance.now() - this.asked > ANSWER_MS ? "no answer" : "sending …"];
    }
    if (offline) {
      [state, text] = ["offline", this.asked !== null && !pressed ? "not sent yet" : "no connection"];
    }
    if (this.model.summary().ended) {
      [state, text] = ["ended", "run has ended"];
    }
    this.model.stopWaits = this.asked !== null && !this.sent;
    this.stop.dataset.state = known ? state : "unknown";
    setText(document.getElementById("stop-state"), text);
  }

  drawSpeed(value, offline) {
    this.speed.disabled = offline;
    if (value === undefined || this.shownSpeed === value) {
      return;
    }
    this.shownSpeed = value;
    const choices = [...new Set([...SPEEDS, value])].filter((each) => each > 0).sort((a, b) => a - b);
    this.speed.replaceChildren(...[...choices, 0].map((each) =>
      new Option(each === 0 ? "maximum" : `${short(each)} ×`, String(each), false, each === value)));
  }

  drawSliders(offline) {
    const { changeable } = this.model.summary();
    const panel = document.getElementById("sliders");
    panel.hidden = changeable.length === 0;
    document.getElementById("panels").dataset.sliders = changeable.length ? "yes" : "no";
    for (const each of changeable) {
      const value = this.model.parameters.get(each.name);
      const slider = this.sliders.get(each.name) ?? this.makeSlider(each);
      slider.input.disabled = offline || typeof value !== "number";
      const held = slider.held || performance.now() - slider.moved < HOLD_MS;
      if (typeof value === "number" && !held && slider.shown !== value) {
        slider.shown = value;
        slider.input.value = String(value);
      }
      setText(slider.output, `${typeof value === "number" ? short(value) : "–"}${each.unit ? ` ${each.unit}` : ""}`);
    }
  }

  makeSlider({ name, minimum, maximum }) {
    const row = document.createElement("div"), label = document.createElement("label");
    const input = document.createElement("input"), output = document.createElement("output");
    const isTime = name === "run.time";  // of a recording
    row.className = isTime ? "slider time" : "slider";
    label.textContent = isTime ? "time" : name;
    label.title = name;
    input.id = `slider-${name}`;
    label.htmlFor = input.id;
    Object.assign(input, { type: "range", min: minimum, max: maximum, step: (maximum - minimum) / 200 || 1 });
    row.append(label, input, output);
    document.getElementById("sliders-body").append(row);
    const slider = { input, output, held: false, moved: -Infinity, shown: undefined };
    input.addEventListener("pointerdown", () => { slider.held = true; });
    for (const name of ["pointerup", "pointercancel", "blur"]) {
      input.addEventListener(name, () => { slider.held = false; });
    }
    input.addEventListener("input", () => {
      slider.moved = performance.now();
      slider.shown = undefined;
      this.connection.setParameter(name, Number(input.value));
    });
    this.sliders.set(name, slider);
    return slider;
  }
}
