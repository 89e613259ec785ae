// Few channels over time as lines; commands before their limits, and as they were sent.

import { FONT, LEFT, RIGHT, TEXT, fitText, ticksFor, timeGrid, valueAxis } from "./axes.js";
import { groupColour, palette } from "./palette.js";

const MARGIN = 5;

/// curves: [{store, channel, name, faint}]. Draws them above one another on a surface that was begun.
export function drawLines(surface, range, curves, low, high, memory) {
  const { context, width, height } = surface;
  const plotWidth = width - LEFT - RIGHT, top = MARGIN, bottom = height - MARGIN;
  timeGrid(context, range, plotWidth, 0, height);
  const limits = valueLimits(curves, range, low, high, memory);
  if (!limits) {
    note(context, "no value yet", plotWidth, height);
    return;
  }
  const scale = (value) => bottom - ((value - limits[0]) / (limits[1] - limits[0])) * (bottom - top);
  valueAxis(context, ticksFor(limits[0], limits[1], height), scale, 0, height);
  if (limits[0] < 0 && limits[1] > 0) {
    level(context, scale(0), plotWidth, palette.axis, [4, 3]);
  }
  context.save();
  context.beginPath();
  context.rect(LEFT, 0, plotWidth, height);
  context.clip();
  const place = (seconds) => LEFT + ((seconds - range[0]) / (range[1] - range[0])) * plotWidth;
  for (const curve of [...curves].sort((a, b) => (b.faint ? 1 : 0) - (a.faint ? 1 : 0))) {
    drawCurve(context, curve, range, place, scale);
  }
  context.restore();
  legend(context, curves, plotWidth, height);
}

export function colourOf(curve) {
  return curve.lone ? palette.ink : groupColour(curve.number);
}

function drawCurve(context, curve, range, place, scale) {
  const { store, channel } = curve;
  if (store.head === 0) {
    return;
  }
  context.strokeStyle = curve.faint ? palette.groups[4] : colourOf(curve);
  context.globalAlpha = curve.faint && !curve.lone ? 0.6 : 1;
  context.lineWidth = curve.faint ? 2.5 : 1.4;
  context.lineJoin = "round";
  context.beginPath();
  let down = false, y = NaN, end = place(range[1]);
  const last = store.find(range[1]);
  for (let index = Math.max(store.find(range[0]), store.tail); index <= last; ++index) {
    const x = place(store.time(index)), value = store.value(index, channel);
    if (down) {
      context.lineTo(x, y);  // a value holds until the next one
    }
    down = !Number.isNaN(value);
    if (down) {
      const next = scale(value);
      if (Number.isNaN(y)) {
        context.moveTo(x, next);
      } else {
        context.lineTo(x, next);
      }
      y = next;
    } else {
      y = NaN;
    }
  }
  if (down) {
    end = Math.min(end, place(curve.until()));
    context.lineTo(end, y);
  }
  context.stroke();
  context.globalAlpha = 1;
}

/// Of all values in the range. Grows at once and shrinks slowly, so that the picture does not jump.
function valueLimits(curves, range, low, high, memory) {
  let least = Infinity, most = -Infinity;
  for (const { store, channel } of curves) {
    const last = store.find(range[1]);
    for (let index = Math.max(store.find(range[0]), store.tail); index <= last && store.head > 0; ++index) {
      const value = store.value(index, channel);
      if (value < least) {
        least = value;
      }
      if (value > most) {
        most = value;
      }
    }
  }
  if (!(least <= most) || !Number.isFinite(least) || !Number.isFinite(most)) {
    return memory.limits ?? null;
  }
  const span = most - least || Math.max(1e-3, Math.abs(most) * 0.2, high - low > 0 ? 0.05 * (high - low) : 0);
  let [from, to] = [least - 0.08 * span, most + 0.08 * span];
  if (from > 0 && from < 0.5 * to) {
    from = 0;
  }
  const old = memory.limits;
  if (old && !memory.fresh) {
    const slow = 0.04;
    from = from < old[0] ? from : old[0] + slow * (from - old[0]);
    to = to > old[1] ? to : old[1] + slow * (to - old[1]);
  }
  memory.fresh = false;
  memory.limits = [from, to];
  return memory.limits;
}

export function note(context, text, plotWidth, height) {
  context.font = FONT;
  context.fillStyle = palette.soft;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, LEFT + plotWidth / 2, height / 2);
}

function level(context, y, plotWidth, colour, dashes) {
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.setLineDash(dashes);
  context.beginPath();
  context.moveTo(LEFT, Math.round(y) + 0.5);
  context.lineTo(LEFT + plotWidth, Math.round(y) + 0.5);
  context.stroke();
  context.setLineDash([]);
}

function legend(context, curves, plotWidth, height) {
  const named = curves.filter((curve) => curve.name);
  const step = Math.min(1.35 * TEXT, (height - 2) / Math.max(1, named.length));
  context.textAlign = "left";
  context.textBaseline = "middle";
  named.forEach((curve, i) => {
    const x = LEFT + plotWidth + 8, y = height / 2 + (i - (named.length - 1) / 2) * step;
    context.strokeStyle = curve.faint ? palette.groups[4] : colourOf(curve);
    context.lineWidth = curve.faint ? 2.5 : 1.6;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + 10, y);
    context.stroke();
    context.fillStyle = palette.soft;
    context.fillText(fitText(context, curve.name, RIGHT - 24), x + 14, y);
  });
}
