// Drawing surfaces, and the ticks of axes.

import { palette } from "./palette.js";
import { compact } from "./text.js";

const FAMILY = 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", sans-serif';
const WIDE = 1700;  // pixels of a window from which on everything is larger, as in style.css

// Pixels; importers see the values of the present window.
export let LABEL = 128;  // names of rows
export let LEFT = 40;  // left of the time axis, for ticks
export let RIGHT = 102;  // and right of it, for legends
export let TEXT = 11;  // height of text
export let FONT = "";
export let FACTOR = 1;  // by which everything is larger

function scale() {
  FACTOR = window.innerWidth >= WIDE ? 1.25 : 1;
  [LABEL, LEFT, RIGHT, TEXT] = [128, 40, 102, 11].map((each) => Math.round(each * FACTOR));
  FONT = `${TEXT}px ${FAMILY}`;
}
scale();
addEventListener("resize", scale);

/// A canvas in device pixels whose drawing unit is the CSS pixel.
export class Surface {
  constructor(canvas, onResize = () => {}) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    [this.width, this.height] = [0, 0];
    new ResizeObserver(() => {
      this.measure();
      onResize();
    }).observe(canvas);
    this.measure();
  }

  measure() {
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.ratio = window.devicePixelRatio || 1;
  }

  /// Clears it; returns false when it is too small to draw on.
  begin() {
    const [width, height] = [Math.round(this.width * this.ratio), Math.round(this.height * this.ratio)];
    if (width < 2 || height < 2) {
      return false;
    }
    if (this.canvas.width !== width || this.canvas.height !== height) {
      [this.canvas.width, this.canvas.height] = [width, height];
    }
    this.context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    this.context.clearRect(0, 0, this.width, this.height);
    this.context.font = FONT;
    return true;
  }
}

/// Round numbers from low to high, about `count` of them.
export function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count);
  if (!(raw > 0) || !Number.isFinite(raw)) {
    return [];
  }
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((each) => each * power >= raw * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; ++k) {
    found.push(Math.abs(k * step) < 1e-9 * step ? 0 : Number((k * step).toPrecision(12)));
  }
  return found;
}

/// Two round numbers at least where there is room for them.
export function ticksFor(low, high, height) {
  for (let count = Math.max(2, height / 28); ; ++count) {
    const found = ticks(low, high, count);
    if (found.length > 1 || count > Math.max(3, height / 12)) {
      const step = found[1] - found[0], crowded = height * step < 1.3 * TEXT * (high - low);
      return crowded ? found.filter((value) => Math.round(value / step) % 2 === 0) : found;
    }
  }
}

/// Vertical lines at the ticks of the time axis.
export function timeGrid(context, range, width, top, bottom) {
  context.strokeStyle = palette.grid;
  context.lineWidth = 1;
  context.beginPath();
  for (const tick of timeTicks(range, width)) {
    const x = Math.round(LEFT + ((tick - range[0]) / (range[1] - range[0])) * width) + 0.5;
    context.moveTo(x, top);
    context.lineTo(x, bottom);
  }
  context.stroke();
}

export function timeTicks(range, width) {
  return ticks(range[0], range[1], Math.max(2, width / 110));
}

/// Left edge of a plot with its ticks. scale: value -> y.
export function valueAxis(context, values, scale, top, bottom) {
  context.strokeStyle = palette.axis;
  context.fillStyle = palette.soft;
  context.lineWidth = 1;
  context.textAlign = "right";
  context.textBaseline = "middle";
  context.beginPath();
  context.moveTo(LEFT - 0.5, top);
  context.lineTo(LEFT - 0.5, bottom);
  for (const value of values) {
    const y = Math.round(scale(value)) + 0.5;
    context.moveTo(LEFT - 4, y);
    context.lineTo(LEFT, y);
  }
  context.stroke();
  for (const value of values) {
    const y = Math.min(bottom - 0.35 * TEXT, Math.max(top + 0.45 * TEXT, scale(value)));
    context.fillText(compact(value), LEFT - 7, y);
  }
}

/// Text that is cut with an ellipsis to fit.
export function fitText(context, text, width) {
  if (context.measureText(text).width <= width) {
    return text;
  }
  let end = text.length;
  while (end > 1 && context.measureText(`${text.slice(0, end)}…`).width > width) {
    end -= 1;
  }
  return `${text.slice(0, end)}…`;
}
