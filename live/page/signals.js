// The values of one signal over time: a ring of typed arrays.

import { lastAtOrBefore } from "./search.js";

const MOST_VALUES = 1 << 20;  // 4 MB a signal
const MOST_ROWS = 1 << 14;
export const MOST_CHANNELS = 256;  // stored; of more, means of neighbours

export class SignalStore {
  constructor() {
    this.width = 0;  // of the signal
    this.clear();
  }

  clear() {
    this.head = 0;
    this.newest = -1;
    this.stored = 0;
    this.rows = 0;
  }

  get tail() {
    return Math.max(0, this.head - this.rows);
  }

  get bytes() {
    return this.rows * (8 + 4 * this.stored);
  }

  add(seconds, values) {
    if (values.length !== this.width || this.rows === 0) {
      this.allocate(values.length);
    }
    const row = this.head & (this.rows - 1), begin = row * this.stored, group = this.width / this.stored;
    for (let i = 0; i < this.stored; ++i) {
      if (group === 1) {
        this.values[begin + i] = values[i];
        continue;
      }
      const first = Math.floor(i * group), last = Math.max(first + 1, Math.floor((i + 1) * group));
      let sum = 0;
      for (let j = first; j < last; ++j) {
        sum += values[j];
      }
      this.values[begin + i] = sum / (last - first);
    }
    this.times[row] = seconds;
    this.newest = seconds;
    this.head += 1;
  }

  /// From this time on (s) values are not received.
  interrupt(seconds) {
    if (this.head > 0 && !Number.isNaN(this.value(this.head - 1, 0))) {
      this.add(Math.max(seconds, this.newest), new Float32Array(this.width).fill(NaN));
    }
  }

  allocate(width) {
    this.clear();
    this.width = width;
    this.stored = Math.min(width, MOST_CHANNELS);
    this.rows = MOST_ROWS;
    while (this.rows * this.stored > MOST_VALUES && this.rows > 64) {
      this.rows /= 2;
    }
    this.times = new Float64Array(this.rows);
    this.values = new Float32Array(this.rows * this.stored);
  }

  time(index) {
    return this.times[index & (this.rows - 1)];
  }

  value(index, channel) {
    return this.values[(index & (this.rows - 1)) * this.stored + channel];
  }

  /// Index of the last row at or before `seconds`, which holds at that time; tail - 1 if there is none.
  find(seconds) {
    return lastAtOrBefore(this, this.tail, this.head, seconds);
  }
}
