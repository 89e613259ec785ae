// What a run learns: the return of each episode that has ended, and the weights of synapses that learn.

import { FONT, LEFT, Surface, ticks, ticksFor, valueAxis } from "./axes.js";
import { groupColour, palette } from "./palette.js";
import { counted, short } from "./text.js";
import { setText } from "./text.js";

const MEAN_OF = 10;  // episodes
const MARGIN = 6;  // pixels
const SIZE = 2.2;  // radius of a point

export class LearningPanel {
  constructor(model, episodes, onChange) {
    this.model = model;
    this.episodes = episodes;
    this.panel = document.getElementById("learning");
    this.note = document.getElementById("learning-note");
    this.returns = new Surface(document.getElementById("returns"), onChange);
    this.weights = new Surface(document.getElementById("weights"), onChange);
  }

  reset() {
    this.episodes.table.restart();
  }

  /// Episodes that had ended at the time that is shown: those of a recording go on behind it.
  get ended() {
    return this.episodes.endedBy(this.model.timeline.newest);
  }

  get hasWeights() {
    return this.model.weights.size > 0;
  }

  /// Which plots there are.
  update() {
    const some = this.ended > 0;
    this.returns.canvas.hidden = !some;
    this.weights.canvas.hidden = !this.hasWeights;
    this.panel.hidden = !some && !this.hasWeights;
    document.getElementById("panels").dataset.learning = this.panel.hidden ? "no" : "yes";
    setText(this.note, some ? this.describe() : "");
  }

  describe() {
    const rows = this.episodes.rows.slice(0, this.ended), last = rows.at(-1);
    const successes = rows.filter((each) => each.success).length;
    return `${counted(rows.length, "episode")}   ${counted(successes, "success")}   last return ${short(last.total)}`;
  }

  draw() {
    if (!this.panel.hidden) {
      if (this.ended > 0 && this.returns.begin()) {
        drawReturns(this.returns, this.episodes.rows.slice(0, this.ended));
      }
      if (this.hasWeights && this.weights.begin()) {
        drawWeights(this.weights, [...this.model.weights.values()]);
      }
    }
  }
}

/// A frame with axes; returns {x, y}, which map numbers to pixels.
function axes({ context, width, height }, [left, right], [low, high], name, marks) {
  const top = MARGIN, bottom = height - 26, end = width - MARGIN;
  const x = (value) => LEFT + ((value - left) / (right - left || 1)) * (end - LEFT);
  const span = high - low || Math.max(1e-3, 0.2 * Math.abs(high));
  const y = (value) => bottom - ((value - low + 0.06 * span) / (1.12 * span)) * (bottom - top);
  valueAxis(context, ticksFor(low, low + span, bottom - top), y, top, bottom);
  context.textAlign = "center";
  context.textBaseline = "top";
  context.beginPath();
  context.moveTo(LEFT, bottom + 0.5);
  context.lineTo(end, bottom + 0.5);
  for (const mark of marks) {
    context.moveTo(Math.round(x(mark)) + 0.5, bottom);
    context.lineTo(Math.round(x(mark)) + 0.5, bottom + 4);
    context.fillText(short(mark), x(mark), bottom + 6);
  }
  context.stroke();
  context.textAlign = "right";
  context.fillText(name, end, bottom + 14);
  return { x, y };
}
