// The graph of nodes and connections as SVG, with the rates of spikes on its edges.

import { arrange } from "./layers.js";
import { groupColour, onTheme, palette } from "./palette.js";
import { makeRows } from "./rows.js";
import { counted, fixed, setText, short } from "./text.js";

const SVG = "http://www.w3.org/2000/svg";
const MOST_LOOSE = 2;  // nodes in a layer; with more, nodes are small and have no class
const LEAST_GAP = 108;  // between layers, for the text on the edges
const MOST_GAP = 190;
const MOST_SCALE = 1.25;
const CHARACTER = 7.6;  // pixels, about

export class Graph {
  /// open(kind, item): shows a node (its name) or a link.
  constructor(model, open) {
    this.model = model;
    this.open = open;
    this.panel = document.getElementById("graph");
    this.body = document.getElementById("graph-body");
    this.live = [];
    this.structure = null;
    onTheme(() => { this.structure = null; });
    new ResizeObserver(() => { this.structure = null; }).observe(this.body);
  }

  update() {
    const { resolved } = this.model;
    this.panel.hidden = !Object.keys(resolved?.nodes ?? {}).length;
    if (this.panel.hidden || this.structure === this.model.structure) {
      return;
    }
    this.structure = this.model.structure;
    this.build(resolved);
  }

  build(resolved) {
    const { layers, edges, isNode } = arrange(resolved);
    const tallest = Math.max(...layers.map((names) => names.length));
    this.compact = tallest > MOST_LOOSE;
    this.panel.style.height = this.compact ? `clamp(140px, ${Math.min(30, 6 + 4.5 * tallest)}vh, 330px)` : "";
    this.nodeHeight = this.compact ? 25 : 40;
    const row = this.compact ? 38 : 58, widest = layers.map((names) =>
      Math.max(...names.filter(isNode).map((name) => this.widthOf(name)), 0));
    const back = edges.some((edge) => edge.back);
    const height = (tallest - 1) * row + this.nodeHeight + 24 + (back ? 26 : 0);
    // The picture has the shape of its panel, so that it fills the width at a readable size.
    const aspect = this.body.clientWidth / Math.max(1, this.body.clientHeight);
    const nodes = widest.reduce((a, b) => a + b, 0), gaps = Math.max(1, layers.length - 1);
    const gap = Math.max(LEAST_GAP, Math.min(MOST_GAP, (Math.max(height, 84) * aspect - nodes - 24) / gaps));
    const places = new Map();
    let left = 12;
    layers.forEach((names, i) => {
      names.forEach((name, k) => places.set(name, {
        x: left + widest[i] / 2, y: 12 + this.nodeHeight / 2 + ((tallest - names.length) / 2 + k) * row,
        width: isNode(name) ? this.widthOf(name) : widest[i],
      }));
      left += widest[i] + gap;
    });
    const [width, least] = [left - gap + 12, this.body.clientWidth / MOST_SCALE];  // a small graph is not blown up
    const box = [Math.min(0, (width - least) / 2), 0, Math.max(width, least), height];
    const svg = make("svg", { viewBox: box.join(" "), role: "group" });
    this.live = [];
    this.numbers = new Map(makeRows(this.model).map((each) => [each.key, each.number]));
    edges.forEach((edge) => svg.append(this.edge(edge, edges, places, height)));
    [...places].filter(([name]) => isNode(name)).forEach(([name, place]) => svg.append(this.node(name, place)));
    this.body.replaceChildren(svg);
    setText(document.getElementById("graph-note"), [counted(Object.keys(resolved.nodes).length, "node"),
      counted(resolved.connections.length, "connection"), `tick ${short(resolved.tick_ns / 1e6)} ms`].join(", "));
  }

  widthOf(name) {
    const below = this.compact ? 0 : this.classOf(name).length * 0.86;
    return Math.max(70, 22 + CHARACTER * Math.max(name.length * 1.08, below));
  }

  classOf(name) {
    const node = this.model.resolved.nodes[name] ?? {};
    return node.node ?? node.simulator ?? node.binary ?? "";
  }

  node(name, { x, y, width }) {
    const group = button("node", `Node ${name}`);
    group.dataset.node = name;
    const type = this.compact ? "" : this.classOf(name);
    group.append(make("rect", { x: x - width / 2, y: y - this.nodeHeight / 2, width, height: this.nodeHeight, rx: 7 }));
    group.append(text(name, x, y + (type ? -2 : 5), "name"));
    if (type) {
      group.append(text(type, x, y + 13, "class"));
    }
    const tip = make("title", {});
    tip.textContent = `${name}: ${this.classOf(name)}`;
    group.append(tip);
    act(group, () => this.open("node", name));
    return group;
  }

  edge(edge, edges, places, height) {
    const group = button("edge", `Connection ${edge.from} to ${edge.to}`);
    group.dataset.edge = `${edge.from}->${edge.to}`;
    const outputs = edge.connections.map((each) => this.model.outputs.get(each.from));
    const spikes = outputs.find((each) => each?.kind === "spikes");
    const colour = spikes ? groupColour(this.numbers.get(spikes.key)) : palette.axis;
    const [begin, end] = [places.get(edge.from), places.get(edge.to)];
    const line = edge.back ? loop(begin, end, height) : way([begin, ...edge.via.map((name) => places.get(name)), end]);
    const path = make("path", { class: "line", d: line, stroke: colour });
    group.append(make("path", { class: "hit", d: line }), path);
    group.append(make("path", { fill: colour, d: `M${end.x - end.width / 2} ${end.y} l-8 -4 v8 z` }));
    // Where edges meet, their texts stand apart: at the ends that do not meet.
    const meet = edges.filter((each) => each.to === edge.to).length > 1;
    const part = edges.filter((each) => each.from === edge.from).length > 1;
    const whole = path.getTotalLength(), near = 0.42 * whole / (edge.via.length + 1);
    const middle = path.getPointAtLength(edge.via.length || (meet && !part) ? near : part && !meet ? whole - near : whole / 2);
    group.append(text(this.label(edge), middle.x, middle.y - 5, meet && part && this.compact ? "crowded" : ""));
    if (spikes) {
      const live = text("", middle.x, middle.y + 14, "live");
      group.append(live);
      this.live.push([spikes.key, live]);
    }
    act(group, () => this.open("edge", edge));
    return group;
  }

  /// Width, and delay if there is one.
  label({ connections }) {
    const [{ width, delay_ticks: delay }] = connections;
    return [connections.length > 1 ? `${connections.length} ×` : "", `[${width.toLocaleString("en")}]`,
            delay ? `${short(delay * this.model.resolved.tick_ns / 1e6)} ms` : ""].filter(Boolean).join(" ");
  }

  draw() {
    for (const [key, element] of this.live) {
      const rate = this.model.rateOf(key);
      if (!Number.isNaN(rate)) {
        setText(element, `${rate < 10 ? fixed(rate, 1) : short(Math.round(rate))} spikes/s`);
      }
    }
  }
}

/// A curve through places from left to right; it leaves and enters them level.
function way(places) {
  const [first, ...others] = places;
  let x = first.x + first.width / 2, { y } = first, line = `M${x} ${y}`;
  others.forEach((place, i) => {
    const to = place.x - place.width / 2, bend = 0.45 * (to - x);
    line += ` C${x + bend} ${y} ${to - bend} ${place.y} ${to} ${place.y}`;
    x = to;
    if (i < others.length - 1) {  // past the nodes of a layer between
      x = place.x + place.width / 2;
      line += ` H${x}`;
    }
    ({ y } = place);
  });
  return line;
}

/// Feedback: below everything, and back.
function loop(from, to, height) {
  const low = height - 14, right = from.x + from.width / 2, left = to.x - to.width / 2;
  return `M${right} ${from.y} C${right + 40} ${from.y} ${right + 40} ${low} ${right - 10} ${low} ` +
    `H${left + 10} C${left - 40} ${low} ${left - 40} ${to.y} ${left} ${to.y}`;
}

function button(kind, label) {
  return make("g", { class: kind, tabindex: 0, role: "button", "aria-label": label });
}

function make(name, attributes) {
  const element = document.createElementNS(SVG, name);
  Object.entries(attributes).forEach(([key, value]) => element.setAttribute(key, value));
  return element;
}

function text(content, x, y, kind) {
  const element = make("text", { x, y, class: kind });
  element.textContent = content;
  return element;
}

function act(element, open) {
  element.addEventListener("click", open);
  element.addEventListener("keydown", (event) => {
    if (event.key === "Enter" || event.key === " ") {
      event.preventDefault();
      open();
    }
  });
}
