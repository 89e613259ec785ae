// The panel of rasters and signals above one time axis.

import { LABEL, LEFT, RIGHT, Surface, timeTicks } from "./axes.js";
import { Heat } from "./heat.js";
import { palette } from "./palette.js";
import { Raster } from "./raster.js";
import { drawRasterRow } from "./rasterrow.js";
import { fitting, makeRows } from "./rows.js";
import { drawSignalRow } from "./signalrow.js";
import { fixed, setText, short } from "./text.js";

const LONG = 13;  // characters of a name from which on it is smaller

export class TimePanel {
  /// onShown(): called when other rows are shown.
  constructor(model, onShown) {
    this.model = model;
    this.onShown = onShown;
    this.body = document.getElementById("rows");
    this.chips = document.getElementById("shown");
    this.axis = new Surface(document.getElementById("time-axis"));
    this.views = [];  // {row, element, surface, ...} of shown rows
    this.hidden = new Set();
    this.enlarged = null;
    new ResizeObserver(() => { this.structure = null; }).observe(this.body);  // there may be room for more
    this.rasters = new Map();  // by output; kept when rows change
    model.timeline.control(this.body, () => [LABEL + LEFT, RIGHT]);
    this.liveButton = document.getElementById("live");
    const press = (id, act) => document.getElementById(id).addEventListener("click", act);
    press("live", () => model.timeline.goLive());
    press("zoom-in", () => model.timeline.zoom(0.5));
    press("zoom-out", () => model.timeline.zoom(2));
  }

  reset() {
    this.rasters.clear();
    this.hidden.clear();
    this.touched = false;
    this.structure = null;
    this.enlarged = null;
  }

  /// The data are forgotten; rows and what is shown of them stay.
  rewind() {
    this.rasters.forEach((raster) => raster.reset());
  }

  /// Rows that are shown; also those behind one that is enlarged.
  get wanted() {
    return (this.rows ?? []).filter((row) => !this.hidden.has(row.key));
  }

  /// True for outputs that the page needs.
  shows(output) {
    return this.wanted.some((row) => row.output === output);
  }

  update() {
    if (this.structure === this.model.structure) {
      return;
    }
    this.structure = this.model.structure;
    this.rows = makeRows(this.model);
    this.choose();
    this.build();
  }

  /// At first as many rows as there is room for; what the user changes stays.
  choose() {
    if (this.touched) {
      return;
    }
    const chosen = fitting(this.rows, this.body.clientHeight || 430);
    this.hidden = new Set(this.rows.map((row) => row.key).filter((key) => !chosen.has(key)));
  }

  build() {
    const shown = this.enlarged ? this.rows.filter((row) => row.key === this.enlarged) : this.wanted;
    const old = new Map(this.views.map((view) => [view.row.key, view]));
    this.views = shown.map((row) => this.view(row, old.get(row.key)));
    this.body.replaceChildren(...this.views.map((view) => view.element));
    if (!this.views.length) {
      const text = document.createElement("p");
      text.className = "empty";
      text.textContent = this.rows.length ? "No output is selected." : "No output has sent data yet.";
      this.body.append(text);
    }
    this.buildChips();
    this.onShown();
  }

  view(row, old) {
    if (old?.row.kind === row.kind && old.row.output === row.output) {
      old.row = row;
      this.label(old);
      return old;
    }
    const element = document.createElement("div");
    element.className = "row";
    element.dataset.row = row.key;
    const label = document.createElement("div");
    label.className = "label";
    const name = document.createElement("button");
    name.type = "button";
    const sub = document.createElement("span"), now = document.createElement("span");
    now.className = "now";
    label.append(name, sub, now);
    const plots = document.createElement("div");
    plots.className = "plots";
    const view = { row, element, name, sub, now, memory: {} };
    const canvas = document.createElement("canvas");
    plots.append(canvas);
    view.surface = new Surface(canvas);
    if (row.kind === "raster") {
      view.pixels = document.createElement("canvas");
      view.pixels.dataset.output = row.key;
      plots.append(view.pixels);
      if (!this.rasters.has(row.key)) {
        this.rasters.set(row.key, new Raster(row.output.store));
      }
      view.raster = this.rasters.get(row.key);
    } else {
      canvas.dataset.output = row.key;
      view.heat = row.kind === "heat" ? new Heat(row.output.store) : null;
    }
    name.addEventListener("click", () => this.enlarge(row.key));
    label.addEventListener("dblclick", (event) => event.stopPropagation());
    label.addEventListener("pointerdown", (event) => event.stopPropagation());
    element.append(label, plots);
    this.label(view);
    return view;
  }

  label({ row, element, name, sub }) {
    element.style.flex = `${row.share} 0 ${row.least}px`;
    name.textContent = row.title;
    name.className = row.title.length > LONG ? "long" : "";
    sub.textContent = describe(row);
    name.title = `${row.key}${sub.textContent ? `: ${sub.textContent}` : ""}. ` +
      `${row.command ? "Pale: before limits. " : ""}Click: enlarge, and back.`;
  }

  enlarge(key) {
    this.enlarged = this.enlarged === key ? null : key;
    this.build();
  }

  /// A button for each output; it shows or hides all its rows.
  buildChips() {
    const outputs = new Map(this.rows.map((row) => [row.output.key, row]));
    this.chips.replaceChildren(...[...outputs].map(([key, row]) => {
      const own = this.rows.filter((each) => each.output.key === key).map((each) => each.key);
      const shown = own.some((each) => !this.hidden.has(each));
      const chip = document.createElement("button");
      chip.type = "button";
      chip.textContent = row.title;
      chip.dataset.show = key;
      chip.title = `${shown ? "Hide" : "Show"} ${key}`;
      chip.setAttribute("aria-pressed", String(shown));
      chip.addEventListener("click", () => {
        this.touched = true;
        this.enlarged = null;
        own.forEach((each) => (shown ? this.hidden.add(each) : this.hidden.delete(each)));
        this.build();
        this.chips.querySelector(`[data-show="${CSS.escape(key)}"]`).focus();
      });
      return chip;
    }));
  }

  draw() {
    const { timeline } = this.model;
    const range = timeline.range;
    for (const view of this.views) {
      if (view.row.kind === "raster") {
        drawRasterRow(view, range, this.model);
      } else {
        drawSignalRow(view, range, this.model);
      }
    }
    this.drawAxis(range);
    this.liveButton.disabled = timeline.live;
    this.liveButton.dataset.running = String(this.model.running());
    setText(this.liveButton, !timeline.live ? "▶ live" : this.model.running() ? "● live" : "newest");
    const { span } = timeline;
    setText(document.getElementById("span"), span >= 1 ? `${short(span)} s` : `${short(span * 1e3)} ms`);
  }

  drawAxis(range) {
    const { axis } = this;
    if (!axis.begin()) {
      return;
    }
    const { context, width } = axis;
    const plotWidth = width - LEFT - RIGHT;
    context.strokeStyle = palette.axis;
    context.fillStyle = palette.soft;
    context.textBaseline = "top";
    context.textAlign = "center";
    context.beginPath();
    context.moveTo(LEFT, 0.5);
    context.lineTo(LEFT + plotWidth, 0.5);
    const marks = timeTicks(range, plotWidth);
    const digits = marks.length > 1 ? Math.max(0, -Math.floor(Math.log10((marks[1] - marks[0]) * 1.0001))) : 1;
    for (const mark of marks) {
      const x = LEFT + ((mark - range[0]) / (range[1] - range[0])) * plotWidth;
      context.moveTo(Math.round(x) + 0.5, 0);
      context.lineTo(Math.round(x) + 0.5, 5);
      context.fillText(fixed(mark, digits), x, 8);
    }
    context.stroke();
    context.textAlign = "left";
    context.fillText("time (s)", LEFT + plotWidth + 22, 8);
  }
}

/// What a row shows, below its name.
function describe({ kind, beams, label, unit, channels, output }) {
  if (kind === "raster") {
    return "";  // the number of neurons, as soon as it is known
  }
  if (kind === "heat") {
    return `${channels.length} ${beams ? "beams" : "channels"}${label && !beams ? `, ${label}` : ""}`;
  }
  if (label) {
    return channels.length === 1 && unit ? `${label} (${unit})` : label;
  }
  return output.store.width > 1 ? `${output.store.width} channels` : "signal";
}
