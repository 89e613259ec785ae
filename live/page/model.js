// What the page knows about the run: its description, the newest data of every output, counters.

import { makeDecoder } from "./decoder.js";
import { commandFields, readField } from "./fields.js";
import { SignalStore } from "./signals.js";
import { SpikeStore, readSpikes } from "./spikes.js";
import { Timeline } from "./timeline.js";
import { WeightStore } from "./weights.js";

const ALL_SPIKES = 1 << 24;  // kept of all outputs together: 128 MB
const MOST_SPIKES = 1 << 22;  // of one output: 32 MB, four seconds of a million spikes a second
const LATENCIES = 1000;
const SCANS = 64;
const MOST_ERRORS = 20;

export class Model {
  constructor() {
    this.timeline = new Timeline();
    this.text = new TextDecoder();
    this.reset();
  }

  /// Before the first run, and when another one begins.
  reset() {
    this.resolved = null;
    this.world = null;
    this.outputs = new Map();  // by "NODE.PORT"
    this.sent = new Map();  // commands that were sent, by node
    this.processes = new Map();  // newest status, by process
    this.parameters = new Map();
    this.latencies = [];
    this.scans = [];
    this.picture = null;
    this.weights = new Map();  // of synapses that learn, by topic
    this.messages = {};  // counts by topic
    this.errors = [];
    this.losses = {};  // of the server: lost, bytes that it could not read in time; dropped, messages for this page
    this.leftOut = 0;  // messages that could not be read or drawn
    this.dataAt = null;  // when the newest data came (performance.now())
    this.timeline.reset();
    this.structure = (this.structure ?? 0) + 1;  // grows when outputs appear or change
  }

  /// Of a recording another part comes: what is shown stays, without the data so far.
  rewind() {
    [...this.outputs.values(), ...this.sent.values()].forEach(({ store }) => store.clear());
    this.processes.forEach(({ rate }) => { rate.marks = []; });
    this.latencies = [];
    this.scans = [];
    this.picture = null;
    this.dataAt = null;
    this.timeline.rewind();
  }

  describe(resolved, world) {
    this.resolved = resolved;
    this.world = world;
    for (const [name, node] of Object.entries(resolved?.nodes ?? {})) {
      if (node.node === "ros_command" && !this.sent.has(name)) {
        this.sent.set(name, { topic: node.topic, fields: commandFields(node), store: new SignalStore() });
      }
    }
    this.structure += 1;
  }

  /// The nodes in the order in which data pass through them.
  width(key) {
    const widths = (this.resolved?.connections ?? []).filter((each) => each.from === key).map((each) => each.width);
    return Math.max(0, ...widths);
  }

  /// Decides what a new channel is for; sets channel.role and channel.consume(seconds, bytes).
  classify(channel) {
    const [, node, port] = /^\/([^/]+)\/([^/]+)$/.exec(channel.topic) ?? [];
    const schema = channel.schemaName.replace("/msg/", "/");
    if (channel.topic === "/spikeloop/status") {
      this.role(channel, "status", (seconds, bytes) => this.receiveStatus(JSON.parse(this.text.decode(bytes))));
    } else if (channel.topic === "/spikeloop/view") {
      this.role(channel, "view", (seconds, bytes) => { this.losses = JSON.parse(this.text.decode(bytes)); });
    } else if (schema === "spikeloop/Spikes") {
      this.spikes(channel, node, port);
    } else if (schema === "spikeloop/Signal") {
      this.signal(channel, node, port);
    } else if (schema === "spikeloop/Weights") {
      const store = this.weights.get(channel.topic) ?? new WeightStore(channel.topic);
      this.weights.set(channel.topic, store);
      this.role(channel, "weights", (seconds, bytes) => store.add(seconds, bytes));
    } else if (schema === "sensor_msgs/LaserScan") {
      this.decoded(channel, "scan", (seconds, message) => this.receiveScan(seconds, message));
    } else if (schema === "sensor_msgs/Image" || schema === "sensor_msgs/CompressedImage") {
      this.decoded(channel, "picture", (seconds, message) => this.receivePicture(seconds, message, channel.topic));
    } else {
      const targets = [...this.sent.values()].filter((each) => each.topic === channel.topic);
      channel.role = "other";
      if (targets.length) {
        this.decoded(channel, "sent", (seconds, message) => targets.forEach((each) =>
          each.store.add(seconds, each.fields.map((field) => readField(message, field.path)))));
        targets.forEach((each) => { each.channel = channel; });
      }
    }
  }

  role(channel, role, consume) {
    channel.role = role;
    channel.consume = consume;
  }

  /// The definition is read with the first message: an error in it concerns this channel only.
  decoded(channel, role, use) {
    let decode = null;
    this.role(channel, role, (seconds, bytes) => {
      decode ??= makeDecoder(channel);
      use(seconds, decode(bytes));
    });
  }

  output(node, port, kind, make) {
    const key = `${node}.${port}`;
    if (!this.outputs.has(key)) {
      this.outputs.set(key, { key, node, port, kind, store: make() });
      this.structure += 1;
    }
    return this.outputs.get(key);
  }

  spikes(channel, node, port) {
    const output = this.output(node, port, "spikes", () => new SpikeStore(MOST_SPIKES));
    channel.output = output;
    const rings = [...this.outputs.values()].filter((each) => each.kind === "spikes");
    let most = MOST_SPIKES;
    while (most * rings.length > ALL_SPIKES && most > 1 << 16) {
      most /= 2;
    }
    rings.forEach((each) => { each.store.most = Math.max(most, each.store.size); });
    this.role(channel, "output", (seconds, bytes) => {
      const batch = readSpikes(bytes);
      if (batch) {
        output.store.add(batch);
        this.timeline.advance(output.store.newest);
        output.heardAt = performance.now();
      }
    });
  }

  signal(channel, node, port) {
    if (port === "latency") {
      this.role(channel, "latency", (seconds, bytes) => this.receiveLatency(readValues(bytes)[0]));
      return;
    }
    const kind = port === "command" && this.isCommand(node) ? "command" : "signal";
    const output = this.output(node, port, kind, () => new SignalStore());
    channel.output = output;
    this.role(channel, "output", (seconds, bytes) => {
      const width = output.store.width;
      output.store.add(seconds, readValues(bytes));
      if (output.store.width !== width) {
        this.structure += 1;
      }
    });
  }

  isCommand(node) {
    return !this.resolved || this.resolved.nodes?.[node]?.node === "ros_command";
  }

  receive(channel, seconds, bytes) {
    this.messages[channel.topic] = (this.messages[channel.topic] ?? 0) + 1;
    if (channel.role !== "status") {
      this.dataAt = performance.now();
      this.timeline.advance(seconds);
    }
    try {
      channel.consume?.(seconds, bytes);
    } catch (error) {
      this.fail(`${channel.topic}: ${error.message}`);
    }
  }

  fail(text) {
    this.leftOut += 1;
    if (this.errors.length < MOST_ERRORS && !this.errors.includes(text)) {
      this.errors.push(text);
      console.warn(`spikeloop: ${text}`);
    }
  }

  receiveStatus(status) {
    const old = this.processes.get(status.process);
    const rate = old?.rate ?? { marks: [] };
    rate.marks.push([status.simulated_s, status.wall_s, status.spikes ?? {}]);
    while (rate.marks.length > 2 && status.wall_s - rate.marks[0][1] > 2) {
      rate.marks.shift();
    }
    this.processes.set(status.process, { ...status, rate });
    this.timeline.advance(status.simulated_s);
  }

  receiveLatency(milliseconds) {
    if (Number.isFinite(milliseconds)) {
      this.latencies.push(milliseconds);
      if (this.latencies.length > LATENCIES) {
        this.latencies.shift();
      }
    }
  }

  receiveScan(seconds, scan) {
    this.scans.push({ seconds, scan });
    if (this.scans.length > SCANS) {
      this.scans.shift();
    }
  }

  receivePicture(seconds, message, topic) {
    if (this.picture && !this.picture.drawn) {
      this.leftOut += 1;
    }
    this.picture = { seconds, message, topic, drawn: false };
  }

  /// No data will come for these outputs, or for any: their gaps are drawn as such.
  interrupt(outputs = [...this.outputs.values(), ...this.sent.values()]) {
    outputs.forEach(({ store }) => store.interrupt(this.timeline.newest));
  }

  /// Spikes per second of simulated time of an output, over the last two seconds of wall time.
  rateOf(key) {
    for (const { rate } of this.processes.values()) {
      const [first, last] = [rate.marks[0], rate.marks.at(-1)];
      if (last && key in last[2] && last[0] > first[0]) {
        return (last[2][key] - (first[2][key] ?? 0)) / (last[0] - first[0]);
      }
    }
    return NaN;
  }

  /// Of all processes: the slowest is shown.
  summary() {
    const all = [...this.processes.values()];
    const factors = all.map((each) => factor(each)).filter(Number.isFinite);
    return {
      known: all.length > 0,
      simulated: all.length ? Math.max(...all.map((each) => each.simulated_s)) : NaN,
      factor: factors.length ? Math.min(...factors) : NaN,
      overruns: all.reduce((sum, each) => sum + (each.overruns ?? 0), 0),
      lost: this.losses.lost ?? 0,
      dropped: this.losses.dropped ?? 0,
      paused: all.some((each) => each.paused),
      ended: all.length > 0 && all.every((each) => each.ended),
      commands: all.flatMap((each) => each.commands ?? []),
      changeable: all.flatMap((each) => each.changeable ?? []),
    };
  }

  get bytes() {
    return [...this.outputs.values(), ...this.sent.values()].reduce((sum, each) => sum + each.store.bytes, 0);
  }
}

/// Simulated time by wall time: over the last two seconds, and of all the run when it has ended.
function factor({ ended, simulated_s: simulated, wall_s: wall, rate: { marks } }) {
  if (ended) {
    return simulated / wall;
  }
  return marks.length ? (marks.at(-1)[0] - marks[0][0]) / (marks.at(-1)[1] - marks[0][1]) : NaN;
}

/// The float64[] of a message spikeloop/msg/Signal.
function readValues(bytes) {
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const count = view.getUint32(4, true);
  if (12 + 8 * count > bytes.length) {
    if (count === 0) {
      return new Float64Array(0);
    }
    throw new Error("damaged message of a signal");
  }
  const begin = bytes.byteOffset + 12;
  return new Float64Array(bytes.buffer.slice(begin, begin + 8 * count));
}
