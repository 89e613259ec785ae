// What a run learns: the return of each episode that has ended, and the weights of synapses that learn.

import { Surface } from "./axes.js";
import { drawReturns, drawWeights } from "./learningplots.js";
import { counted, setText, short } from "./text.js";

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
    return this.episodes.rows.slice(0, this.episodes.endedBy(this.model.timeline.newest));
  }

  /// Which plots there are.
  update() {
    const { ended } = this, learns = this.model.weights.size > 0;
    this.returns.canvas.hidden = !ended.length;
    this.weights.canvas.hidden = !learns;
    this.panel.hidden = !ended.length && !learns;
    document.getElementById("panels").dataset.learning = this.panel.hidden ? "no" : "yes";
    if (ended.length) {
      const successes = ended.filter((each) => each.success).length;
      setText(this.note, `${counted(ended.length, "episode")}   ${successes} with success   ` +
        `last ${short(ended.at(-1).total)}`);
    }
  }

  draw() {
    if (this.panel.hidden) {
      return;
    }
    const { ended } = this;  // fewer than at the last update() after a jump back
    if (ended.length && !this.returns.canvas.hidden && this.returns.begin()) {
      drawReturns(this.returns, ended);
    }
    if (!this.weights.canvas.hidden && this.weights.begin()) {
      drawWeights(this.weights, [...this.model.weights.values()]);
    }
  }
}
