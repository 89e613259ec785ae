// Many channels over time as an image, as `spikeloop plot` draws them.

import { LEFT, RIGHT, fitText, ticks, timeGrid, valueAxis } from "./axes.js";
import { note } from "./lines.js";
import { VALUE_TABLE, palette } from "./palette.js";
import { short } from "./text.js";

export class Heat {
  constructor(store) {
    this.store = store;
    this.canvas = document.createElement("canvas");
    this.limits = null;
  }

  /// beams: {first, step} in degrees when the channels are laser beams. until: time up to which values hold.
  draw(surface, range, beams, unit, until) {
    const { context, width, height } = surface;
    const plotWidth = Math.floor(width - LEFT - RIGHT), top = 3, bottom = height - 3;
    timeGrid(context, range, plotWidth, 0, height);
    const { stored, width: channels } = this.store;
    if (!stored) {
      note(context, "no value yet", plotWidth, height);
      return;
    }
    this.fill(range, plotWidth, stored, until);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.canvas, LEFT, top, plotWidth, bottom - top);
    const first = beams ? beams.first - 0.5 * beams.step : -0.5;
    const last = beams ? first + channels * beams.step : channels - 0.5;
    const scale = (value) => bottom - ((value - first) / (last - first)) * (bottom - top);
    const marks = beams ? angleTicks(first, last, height) : ticks(0, channels - 1, Math.max(2, height / 30));
    valueAxis(context, marks.filter((mark) => Number.isInteger(mark)), scale, top, bottom);
    this.bar(context, LEFT + plotWidth + 8, top, bottom, unit);
  }

  /// One pixel a column in time and a channel.
  fill(range, columns, rows, until) {
    const { store, canvas } = this;
    if (canvas.width !== columns || canvas.height !== rows || !this.image) {
      [canvas.width, canvas.height] = [columns, rows];
      this.image = new ImageData(columns, rows);
      this.pixels = new Uint32Array(this.image.data.buffer);
    }
    const first = Math.max(store.tail, store.find(range[0])), last = store.find(range[1]);
    this.findLimits(first, last);
    const [low, high] = this.limits ?? [0, 1];
    const factor = 255 / (high - low || 1), step = (range[1] - range[0]) / columns;
    let index = first - 1;
    let source = -1;  // column with the same row of values
    for (let x = 0; x < columns; ++x) {
      const time = range[0] + (x + 0.5) * step;
      const before = index;
      while (index < last && store.time(index + 1) <= time) {
        index += 1;
      }
      const shown = index >= store.tail && index >= first && time <= until;
      if (shown && index === before && source >= 0) {
        for (let y = 0, at = x; y < rows; ++y, at += columns) {
          this.pixels[at] = this.pixels[at - 1];
        }
        continue;
      }
      source = shown ? x : -1;
      for (let y = 0, at = x; y < rows; ++y, at += columns) {
        const value = shown ? store.value(index, rows - 1 - y) : NaN;
        this.pixels[at] = Number.isNaN(value) ? 0
          : VALUE_TABLE[Math.max(0, Math.min(255, Math.round((value - low) * factor)))];
      }
    }
    canvas.getContext("2d").putImageData(this.image, 0, 0);
  }

  findLimits(first, last) {
    let low = Infinity, high = -Infinity;
    const stride = Math.max(1, Math.floor((last - first) / 200));
    for (let index = first; index <= last; index += stride) {
      for (let channel = 0; channel < this.store.stored; ++channel) {
        const value = this.store.value(index, channel);
        if (value < low && value > -Infinity) {
          low = value;
        }
        if (value > high && value < Infinity) {
          high = value;
        }
      }
    }
    if (low > high) {
      return;
    }
    const old = this.limits;  // colours that change with every value could not be read
    this.limits = old ? [Math.min(old[0], low), Math.max(old[1], high)] : [low, high];
  }

  bar(context, x, top, bottom, unit) {
    if (!this.limits) {
      return;
    }
    const gradient = context.createLinearGradient(0, bottom, 0, top);
    for (let i = 0; i <= 8; ++i) {
      const colour = VALUE_TABLE[Math.round((i / 8) * 255)];
      gradient.addColorStop(i / 8, `rgb(${colour & 255}, ${colour >> 8 & 255}, ${colour >> 16 & 255})`);
    }
    context.fillStyle = gradient;
    context.fillRect(x, top, 8, bottom - top);
    context.fillStyle = palette.soft;
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillText(short(this.limits[1]), x + 13, top + 6);
    context.fillText(short(this.limits[0]), x + 13, bottom - 5);
    if (unit && bottom - top > 44) {
      context.fillText(fitText(context, unit, RIGHT - 22), x + 13, (top + bottom) / 2);
    }
  }
}

function angleTicks(first, last, height) {
  const step = [30, 45, 90, 180].find((each) => (last - first) / each <= Math.max(2.1, height / 26)) ?? 180;
  const found = [];
  for (let angle = Math.ceil(first / step - 0.02) * step; angle <= last + 0.02 * step; angle += step) {
    found.push(angle === 0 ? 0 : angle);
  }
  return found;
}
