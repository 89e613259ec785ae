// The spikes of one output: a ring of typed arrays that grows up to a limit, and counts for the rate.

export const STEP_S = 1e-5;  // resolution of stored times
const STEPS_PER_S = 1e5;
const LEAST = 1 << 15;
export const RATE_BIN_S = 1e-3;
const MOST_GAPS = 50;
const RATE_BINS = 1 << 17;  // 131 s

/// Times (ns) and channels of a message spikeloop/msg/Spikes; null if it is empty.
/// Read by hand, as the 64-bit integers of the general decoder would be far slower.
export function readSpikes(bytes) {
  if (bytes.length < 16) {
    return null;
  }
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const count = view.getUint32(4, true);
  const end = 12 + 8 * count;
  if (count === 0 || end + 4 + 4 * count > bytes.length || view.getUint32(end, true) !== count) {
    if (count === 0) {
      return null;
    }
    throw new Error("damaged message of spikes");
  }
  const from = bytes.byteOffset;
  return {
    count,
    halves: new Uint32Array(bytes.buffer.slice(from + 12, from + end)),  // low and high word of each time
    channels: new Uint32Array(bytes.buffer.slice(from + end + 4, from + end + 4 + 4 * count)),
  };
}

export class SpikeStore {
  /// most: spikes that are kept, a power of 2; 8 bytes each.
  constructor(most) {
    this.most = most;
    this.bins = new Uint32Array(RATE_BINS);
    this.clear();
  }

  clear() {
    this.size = Math.min(LEAST, this.most);
    this.steps = new Uint32Array(this.size);
    this.channels = new Uint32Array(this.size);
    this.head = 0;  // spikes ever stored; the newest one is at head - 1
    this.base = 0;  // steps that stored ones are counted from
    this.newest = -1;  // s
    this.width = 0;
    this.bins.fill(0);
    this.newestBin = -1;
    this.gaps = [];  // [from, to] in s: no data were asked for, or there was no connection
    this.interruptedAt = 0;
  }

  get tail() {
    return Math.max(0, this.head - this.size);
  }

  get bytes() {
    return 8 * this.size + 4 * RATE_BINS;
  }

  /// From this time on (s) spikes are not received, until the next ones come.
  interrupt(seconds) {
    this.interruptedAt ??= Math.max(seconds, this.newest);
  }

  add({ count, halves, channels }) {
    if (this.interruptedAt !== null) {
      this.gaps.push([this.interruptedAt, (halves[0] + 4294967296 * halves[1]) * 1e-9]);
      this.gaps.splice(0, this.gaps.length - MOST_GAPS);
      this.interruptedAt = null;
    }
    while (this.head + count > this.size && this.size < this.most) {
      this.grow();
    }
    const mask = this.size - 1, scale = STEPS_PER_S / 1e9;
    let { head, width, newest } = this;
    for (let i = 0; i < count; ++i) {
      const ns = halves[2 * i] + 4294967296 * halves[2 * i + 1];
      const step = Math.floor(ns * scale) - this.base;
      if (step > 4294967295) {
        this.rebase();  // after 12 hours of simulated time
        this.head = head;
        this.add({ count: count - i, halves: halves.subarray(2 * i), channels: channels.subarray(i) });
        return;
      }
      const channel = channels[i], at = head++ & mask;
      this.steps[at] = step;
      this.channels[at] = channel;
      if (channel >= width) {
        width = channel + 1;
      }
      const seconds = ns * 1e-9;
      if (seconds > newest) {
        newest = seconds;
      }
      this.count(Math.floor(ns * 1e-6));
    }
    Object.assign(this, { head, width, newest });
  }

  /// One more spike in the bin of this millisecond.
  count(bin) {
    if (bin > this.newestBin) {
      const first = Math.max(this.newestBin + 1, bin - RATE_BINS + 1);
      for (let each = first; each <= bin; ++each) {
        this.bins[each & (RATE_BINS - 1)] = 0;
      }
      this.newestBin = bin;
    }
    if (bin > this.newestBin - RATE_BINS) {
      this.bins[bin & (RATE_BINS - 1)] += 1;
    }
  }

  /// No spike will come before this millisecond: the rate is known up to it.
  advance(bin) {
    if (bin > this.newestBin) {
      this.count(bin);
      this.bins[bin & (RATE_BINS - 1)] -= 1;
    }
  }

  grow() {
    const { size } = this;
    for (const name of ["steps", "channels"]) {
      const larger = new Uint32Array(2 * size);
      // A ring that was full begins anywhere; in the larger one each spike is at its number again.
      for (let index = this.tail; index < this.head; ++index) {
        larger[index & (2 * size - 1)] = this[name][index & (size - 1)];
      }
      this[name] = larger;
    }
    this.size = 2 * size;
  }

  /// Forgets all spikes, so that times are small again.
  rebase() {
    this.base = Math.floor(this.newest * STEPS_PER_S);
    this.steps.fill(0);
    this.channels.fill(4294967295);
  }

  /// Index of the first stored spike that can lie at or after `seconds`. Spikes are stored almost in order;
  /// those of a batch may be late by a tick, hence the margin.
  find(seconds) {
    const step = Math.max(0, Math.floor((seconds - 0.05) * STEPS_PER_S) - this.base);
    let low = this.tail, high = this.head;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.steps[middle & (this.size - 1)] < step) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }

  /// Spikes per second and neuron over [from, to): a Gaussian of deviation kernel (s) over counts of
  /// kernel / 5. As `spikeloop plot`, the kernel is normalised by the part of it that has data.
  rate(from, to, kernel, width) {
    const bin = Math.max(1, Math.round(kernel / 5 / RATE_BIN_S));
    const first = Math.floor(from / RATE_BIN_S / bin), last = Math.ceil(to / RATE_BIN_S / bin);
    const reach = Math.ceil(4 * kernel / RATE_BIN_S / bin);
    const known = Math.floor(this.newestBin / bin);  // the newest bin is not complete
    const counts = new Float64Array(last - first + 2 * reach + 1).fill(NaN);
    for (let i = 0; i < counts.length; ++i) {
      const begin = (first - reach + i) * bin;
      if (begin < 0 || first - reach + i >= known || begin <= this.newestBin - RATE_BINS) {
        continue;
      }
      if (this.gaps.some((gap) => begin < 1e3 * gap[1] && begin + bin > 1e3 * gap[0])) {
        continue;
      }
      let sum = 0;
      for (let each = begin; each < begin + bin; ++each) {
        sum += this.bins[each & (RATE_BINS - 1)];
      }
      counts[i] = sum;
    }
    const weights = Float64Array.from({ length: 2 * reach + 1 }, (_, i) =>
      Math.exp(-0.5 * ((i - reach) * bin * RATE_BIN_S / kernel) ** 2));
    const times = [], rates = [];  // NaN: not known
    for (let i = reach; i < counts.length - reach; ++i) {
      times.push((first - reach + i + 0.5) * bin * RATE_BIN_S);
      if (Number.isNaN(counts[i])) {
        rates.push(NaN);
        continue;
      }
      let sum = 0, inside = 0;
      for (let j = -reach; j <= reach; ++j) {
        const count = counts[i + j];
        if (!Number.isNaN(count)) {
          sum += count * weights[j + reach];
          inside += weights[j + reach];
        }
      }
      rates.push(sum / inside / (bin * RATE_BIN_S) / Math.max(1, width));
    }
    return { times, rates };
  }
}
