// The plots of the panel "Learning".

import { LEFT, TEXT, fitText, ticks, ticksFor, valueAxis } from "./axes.js";
import { groupColour, palette } from "./palette.js";
import { short } from "./text.js";

const MEAN_OF = 10;  // episodes
const MOST = 2000;  // points; of more episodes evenly chosen ones are drawn
const TOP = 7, RIGHT = 14, MORE_LEFT = 8;  // pixels
const SIZE = 2.4;  // radius of a point

/// A point for each episode, filled where it was a success, and the mean return of the last ten.
export function drawReturns(surface, episodes) {
  const { context } = surface, totals = episodes.map((each) => each.total);
  const first = episodes[0].number, last = episodes.at(-1).number;
  const whole = (values) => values.filter(Number.isInteger);
  const { x, y } = axes(surface, [first - 0.5, last + 0.5], extremes(totals), "return", "episode", whole);
  const stride = Math.ceil(episodes.length / MOST);
  context.lineWidth = 1.2;
  for (const { number, total, success } of episodes.filter((_, i) => i % stride === 0)) {
    context.fillStyle = success ? palette.goalEdge : palette.plot;
    context.strokeStyle = success ? palette.goalEdge : palette.axis;
    context.beginPath();
    context.arc(x(number), y(total), SIZE, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
  context.strokeStyle = palette.ink;
  context.lineWidth = 1.6;
  context.beginPath();
  let sum = 0;
  totals.forEach((total, i) => {
    sum += total - (totals[i - MEAN_OF] ?? 0);
    if (i >= MEAN_OF - 1 && i % stride === 0) {
      context.lineTo(x(episodes[i].number), y(sum / MEAN_OF));
    }
  });
  context.stroke();
}

/// Of each projection over time: the median weight, and the band of 80 % of the weights.
export function drawWeights(surface, projections) {
  const { context, width } = surface, known = projections.filter(({ rows }) => rows.length);
  if (!known.length) {
    return;
  }
  const all = known.flatMap(({ rows }) => rows);
  const { x, y } = axes(surface, extremes(all.map((row) => row.seconds)),
                        extremes(all.flatMap(({ low, high }) => [low, high])), "weight", "time (s)", (values) => values);
  known.forEach(({ name, rows }, i) => {
    context.fillStyle = context.strokeStyle = groupColour(i);
    context.globalAlpha = 0.2;
    context.beginPath();
    rows.forEach((row) => context.lineTo(x(row.seconds), y(row.high)));
    [...rows].reverse().forEach((row) => context.lineTo(x(row.seconds), y(row.low)));
    context.fill();
    context.globalAlpha = 1;
    context.lineWidth = 1.6;
    context.beginPath();
    rows.forEach((row) => context.lineTo(x(row.seconds), y(row.median)));
    context.stroke();
    context.textAlign = "left";
    context.textBaseline = "top";
    context.strokeStyle = palette.plot;  // readable above lines
    context.lineWidth = 3;
    const place = [fitText(context, name, width - LEFT - 24), LEFT + 6, TOP + i * 1.25 * TEXT];
    context.strokeText(...place);
    context.fillText(...place);
  });
}

/// Draws both axes; {x, y}: where numbers lie. choose(ticks): those of the horizontal axis.
function axes({ context, width, height }, [left, right], [least, most], name, below, choose) {
  const bottom = height - 2.9 * TEXT, end = width - RIGHT - MORE_LEFT;
  context.translate(MORE_LEFT, 0);  // for returns like −2,000
  const span = most - least || Math.max(1e-3, 0.2 * Math.abs(most)), [low, high] = [least - 0.08 * span, least + 1.08 * span];
  const x = (value) => LEFT + ((value - left) / (right - left || 1)) * (end - LEFT);
  const y = (value) => bottom - ((value - low) / (high - low)) * (bottom - TOP);
  valueAxis(context, ticksFor(low, high, bottom - TOP), y, TOP, bottom);
  context.textAlign = "center";
  context.textBaseline = "top";
  context.beginPath();
  context.moveTo(LEFT, bottom + 0.5);
  context.lineTo(end, bottom + 0.5);
  for (const mark of choose(ticks(left, right, Math.max(2, (end - LEFT) / 40)))) {
    context.moveTo(Math.round(x(mark)) + 0.5, bottom);
    context.lineTo(Math.round(x(mark)) + 0.5, bottom + 4);
    context.fillText(short(mark), x(mark), bottom + 5);
  }
  context.stroke();
  context.fillText(`${name}, ${below}`, (LEFT + end) / 2, bottom + 5 + 1.1 * TEXT);
  return { x, y };
}

function extremes(values) {
  return values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [Infinity, -Infinity]);
}
