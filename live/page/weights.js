// Weights of the synapses of one projection that learn, over the time of the run.

const MOST_ROWS = 1024;

export class WeightStore {
  /// topic: "/NODE/FROM.TO"
  constructor(topic) {
    const [, node, projection] = topic.split("/");
    this.name = `${node}: ${projection.replace(".", " → ")}`;
    this.synapses = 0;  // of all of the projection
    this.newest = new Float64Array(0);  // evenly chosen ones
    this.rows = [];  // {seconds, low, median, high}
  }

  /// A message spikeloop/msg/Weights: uint64 synapses, float64[] weights.
  add(seconds, bytes) {
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const count = view.getUint32(12, true);
    if (count && 20 + 8 * count > bytes.length) {
      throw new Error("damaged message of weights");
    }
    this.synapses = Number(view.getBigUint64(4, true));
    this.newest = Float64Array.from({ length: count }, (_, i) => view.getFloat64(20 + 8 * i, true));
    const sorted = this.newest.slice().sort(), at = (part) => sorted[Math.round(part * (count - 1))];
    if (count) {
      this.rows.push({ seconds, low: at(0.1), median: at(0.5), high: at(0.9) });
    }
    if (this.rows.length > MOST_ROWS) {
      this.rows = this.rows.filter((_, i) => i % 2 === 0);  // every second one of a long run is enough
    }
  }
}
