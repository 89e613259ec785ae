// The raster of one population. Spikes are counted in cells, one pixel wide in time, of a ring of columns; only
// columns with new spikes are coloured again. Few neurons have ticks, many the density of their spikes.

import { alphaTable } from "./palette.js";
import { STEP_S } from "./spikes.js";

const FULL = 0.3;  // part of the cells in use above which shades tell more than dots
const THIN = 0.3, THICK = 0.1;  // part of the cells in use at which ticks become thin, and thick again
const LOOK_MS = 500;  // interval at which the shades are adapted

export class Raster {
  constructor(store) {
    this.store = store;
    this.drawn = 0;  // spikes that were put into the picture, each counted once
    this.key = "";
    this.dark = 1;
    this.looked = 0;
    this.reset();
  }

  reset() {
    this.key = "";
    this.cursor = 0;  // next spike to be read
    this.seen = 0;  // spikes before this one have been counted in `drawn`
  }

  /// Brings the picture up to date and puts it on the canvas (device pixels).
  draw(canvas, range, neurons, colour, ratio) {
    const columns = canvas.width, rows = canvas.height;
    if (columns < 2 || rows < 2) {
      return;
    }
    const perSecond = columns / (range[1] - range[0]);
    this.thick = this.thin ? 1 : Math.max(1, Math.round(1.6 * ratio));  // of ticks
    const end = Math.ceil(range[1] * perSecond - 1e-6);  // column behind the last one
    const key = [columns, rows, perSecond, neurons, this.thick].join();
    if (key !== this.key || end < this.end || end - this.end >= columns) {
      this.rebuild(key, columns, rows, perSecond, end, neurons);
    } else {
      this.advance(end);
    }
    if (colour !== this.colour) {
      this.colour = colour;
      this.table = alphaTable(colour);
      this.dirty = this.end - columns;
    }
    this.adapt();
    this.paint();
    this.show(canvas.getContext("2d"));
  }

  rebuild(key, columns, rows, perSecond, end, neurons) {
    if (this.columns !== columns || this.rows !== rows) {
      this.counts = new Uint16Array(columns * rows);
      this.image = new ImageData(columns, rows);
      this.pixels = new Uint32Array(this.image.data.buffer);
    } else {
      this.counts.fill(0);
    }
    Object.assign(this, { key, columns, rows, perSecond, end, neurons });
    this.dirty = end - columns;
    this.cursor = this.store.find((end - columns) / perSecond);
    this.read();
    this.looked = 0;
  }

  advance(end) {
    for (let column = this.end; column < end; ++column) {
      const begin = this.slot(column) * this.rows;
      this.counts.fill(0, begin, begin + this.rows);
    }
    this.dirty = Math.min(this.dirty, this.end);
    this.end = end;
    this.read();
  }

  slot(column) {
    return ((column % this.columns) + this.columns) % this.columns;
  }

  /// Counts the spikes that have come since the last picture.
  read() {
    const { store, counts, columns, rows, neurons, end } = this;
    const { head, steps, channels, size } = store;
    const mask = size - 1, scale = STEP_S * this.perSecond, first = end - columns;
    const high = rows / neurons;
    const gap = high >= 4 ? 1 : 0;  // between the ticks of neighbours
    const wide = this.thick;
    let dirty = this.dirty, drawn = 0;
    for (let index = Math.max(this.cursor, store.tail); index < head; ++index) {
      const at = index & mask, channel = channels[at];
      const column = Math.floor((steps[at] + store.base) * scale);
      if (column < first || column >= end || channel >= neurons) {
        continue;
      }
      if (column < dirty) {
        dirty = column;
      }
      const bottom = rows - Math.floor(channel * high);
      const top = Math.min(bottom - 1, rows - Math.floor((channel + 1) * high) + gap);
      for (let x = column; x < column + wide && x < end; ++x) {
        const begin = (((x % columns) + columns) % columns) * rows;
        for (let y = top; y < bottom; ++y) {
          counts[begin + y] += 1;
        }
      }
      if (index >= this.seen) {
        drawn += 1;
      }
    }
    this.cursor = head;
    this.seen = Math.max(this.seen, head);
    this.drawn += drawn;
    this.dirty = dirty;
  }

  /// Finds the count that is drawn in the full colour.
  adapt() {
    if (performance.now() - this.looked < LOOK_MS) {
      return;
    }
    this.looked = performance.now();
    const { counts } = this;
    const histogram = new Uint32Array(4096);
    for (let i = 0; i < counts.length; ++i) {
      histogram[Math.min(4095, counts[i])] += 1;
    }
    const used = counts.length - histogram[0];
    const part = used / counts.length;
    this.thin = part > THIN || (this.thin && part > THICK);
    let dark = 1;
    if (used > FULL * counts.length) {
      for (let left = 0.98 * used - histogram[1]; left > 0 && dark < 4095;) {
        dark += 1;
        left -= histogram[dark];
      }
    }
    if (dark !== this.dark && (dark > 1.2 * this.dark || dark < 0.8 * this.dark || dark <= 2)) {
      this.dark = dark;
      this.dirty = this.end - this.columns;
    }
  }

  paint() {
    const { counts, pixels, columns, rows, table } = this;
    const scale = 255 / this.dark;
    for (let column = Math.max(this.dirty, this.end - columns); column < this.end; ++column) {
      const x = this.slot(column), begin = x * rows;
      for (let y = 0, at = x; y < rows; ++y, at += columns) {
        const count = counts[begin + y];
        pixels[at] = count === 0 ? 0 : table[Math.max(1, Math.min(255, Math.round(count * scale)))];
      }
    }
    this.dirty = this.end;  // nothing
  }

  /// The ring from its oldest column on: two parts.
  show(context) {
    const { columns, rows, image } = this;
    const cut = this.slot(this.end);
    context.putImageData(image, -cut, 0, cut, 0, columns - cut, rows);
    if (cut > 0) {
      context.putImageData(image, columns - cut, 0, 0, 0, cut, rows);
    }
  }

  get bytes() {
    return this.counts ? this.counts.byteLength + this.image.data.byteLength : 0;
  }
}
