// A row with the raster of a population, and its rate below.

import { LEFT, RIGHT, ticks, timeGrid, valueAxis } from "./axes.js";
import { groupColour, palette } from "./palette.js";
import { counted, fixed, setText } from "./text.js";

const RATE_SHARE = 0.3;  // of the row
const RATE_LEAST = 22, RATE_MOST = 90;  // pixels
const QUIET_MS = 300;  // without spikes for so long a population is silent, not late

/// The row of a population: its raster, and below it the rate.
export function drawRasterRow(view, range, model) {
  const { surface, pixels, raster, row } = view;
  if (!surface.begin()) {
    return;
  }
  const { context, width, height, ratio } = surface;
  const { store } = row.output;
  const plotWidth = width - LEFT - RIGHT;
  const rateHeight = Math.max(RATE_LEAST, Math.min(RATE_MOST, RATE_SHARE * height));
  const rasterHeight = height - rateHeight - 7;
  const neurons = Math.max(1, model.width(row.key) || store.width);
  const colour = groupColour(row.number);
  timeGrid(context, range, plotWidth, 0, height);
  drawGaps(context, store.gaps, range, plotWidth, height);
  valueAxis(context, neurons > 1 ? neuronTicks(neurons, rasterHeight) : [0],
            (neuron) => 3 + rasterHeight * (1 - (neuron + 0.5) / neurons), 3, 3 + rasterHeight);
  place(pixels, LEFT, 3, plotWidth, rasterHeight, ratio);
  raster.draw(pixels, range, neurons, colour, ratio);
  drawRate(view, range, model, neurons, [5 + rasterHeight, height - 2], colour);
  setText(view.sub, counted(neurons, "neuron"));
}

function drawRate(view, range, model, neurons, [top, bottom], colour) {
  const { surface: { context, width }, row: { key, output } } = view;
  const { store } = output;
  const kernel = kernelWidth(range[1] - range[0]);
  if (performance.now() - (output.heardAt ?? 0) > QUIET_MS && store.head > 0) {
    store.advance(Math.floor(model.timeline.newest * 1e3));
  }
  const { times, rates } = store.rate(...range, kernel, neurons);
  const known = rates.filter((rate) => !Number.isNaN(rate));
  const most = Math.max(...known, 0);
  const goal = niceAbove(most);
  view.memory.top = Math.max(goal, Math.min(view.memory.top ?? goal, 2.5 * goal));
  const limit = view.memory.top;
  const plotWidth = width - LEFT - RIGHT;
  const scale = (rate) => bottom - 1 - (rate / limit) * (bottom - top - 3);
  valueAxis(context, [0, limit], scale, top, bottom);
  context.save();
  context.beginPath();
  context.rect(LEFT, top, plotWidth, bottom - top);
  context.clip();
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  let down = false;
  times.forEach((time, i) => {
    const x = LEFT + ((time - range[0]) / (range[1] - range[0])) * plotWidth;
    const known = !Number.isNaN(rates[i]);
    if (known) {
      context[down ? "lineTo" : "moveTo"](x, scale(rates[i]));
    }
    down = known;
  });
  context.stroke();
  context.restore();
  context.fillStyle = palette.soft;
  context.textAlign = "left";
  context.textBaseline = "middle";
  context.fillText("Hz per neuron", LEFT + plotWidth + 8, (top + bottom) / 2);
  const counted = model.timeline.live ? model.rateOf(key) / neurons : NaN;
  const now = Number.isNaN(counted) ? known.at(-1) : counted;
  setText(view.now, `${fixed(now, now < 10 ? 2 : 1)} Hz`);
}

/// Where no spikes were received; that is not silence.
function drawGaps(context, gaps, range, width, height) {
  const place = (seconds) => LEFT + Math.min(1, Math.max(0, (seconds - range[0]) / (range[1] - range[0]))) * width;
  context.fillStyle = palette.none;
  for (const [from, to] of gaps) {
    if (to > range[0] && from < range[1] && to - from > 0.02) {
      context.fillRect(place(from), 0, place(to) - place(from), height);
    }
  }
}

/// A canvas with exactly as many pixels as the screen has there.
function place(canvas, left, top, width, height, ratio) {
  const [columns, rows] = [Math.floor(width * ratio), Math.floor(height * ratio)];
  if (canvas.width !== columns || canvas.height !== rows) {
    [canvas.width, canvas.height] = [Math.max(1, columns), Math.max(1, rows)];
    Object.assign(canvas.style, {
      inset: "auto", left: `${left}px`, top: `${top}px`, width: `${columns / ratio}px`, height: `${rows / ratio}px`,
    });
  }
}

function neuronTicks(neurons, height) {
  return ticks(0, neurons - 1, Math.max(2, height / 30)).filter(Number.isInteger);
}

/// Standard deviation of the rate's kernel, as in `spikeloop plot`.
function kernelWidth(span) {
  return Math.min(1, Math.max(span / 100, Math.min(0.05, span / 20)));
}

function niceAbove(value) {
  if (!(value > 0)) {
    return 1;
  }
  const power = 10 ** Math.floor(Math.log10(value * 1.05));
  return power * [1, 2, 3, 5, 8, 10].find((step) => step * power >= value * 1.05);
}
