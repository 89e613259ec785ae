// A row with a signal or a command.

import { drawLines } from "./lines.js";
import { fixed, setText } from "./text.js";

/// The row of a quantity: lines, or an image of many channels.
export function drawSignalRow(view, range, model) {
  const { surface, row, heat, memory } = view;
  if (!surface.begin()) {
    return;
  }
  const until = model.timeline.newest;
  if (heat) {
    heat.draw(surface, range, row.beams, row.unit, until);
    setText(view.now, "");
    return;
  }
  const { curves, low, high } = curvesOf(row, until, model);
  drawLines(surface, range, curves, low, high, memory);
  const shown = curves.find((curve) => curve.name === "sent") ?? curves[0];
  setText(view.now, row.channels.length === 1 ? fixed(valueAt(shown, range[1]), 3) : row.unit && `(${row.unit})`);
}

/// The curves of a row; a command has what was sent, too.
function curvesOf(row, until, model) {
  const lone = row.channels.length === 1;
  const sent = row.command ? model.sent.get(row.output.node) : null;
  const own = row.channels.map((channel, number) => ({
    store: row.output.store, channel: channel.channel, number, lone, until: () => until,
    name: sent && lone ? "before limits" : sent || lone ? "" : named(channel.path), faint: Boolean(sent),
  }));
  const real = sent ? row.channels.map((channel, number) => ({
    store: sent.store, channel: channel.channel, number, lone, until: () => until,
    name: lone ? "sent" : named(channel.path), faint: false,
  })) : [];
  return { curves: [...real, ...own], low: row.channels[0]?.low, high: row.channels[0]?.high };
}

/// "effort[name=elbow]" is elbow.
function named(path) {
  return /\[\w+=([^\]]+)\]/.exec(path)?.[1] ?? path;
}

/// Newest value of a curve up to a time. After the connection was lost it stays.
function valueAt({ store, channel }, seconds) {
  const last = store.head > 0 ? store.find(seconds) : -1;
  for (let index = last; index >= Math.max(store.tail, last - 1); --index) {
    const value = store.value(index, channel);
    if (!Number.isNaN(value)) {
      return value;
    }
  }
  return NaN;
}
