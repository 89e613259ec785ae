// Which rows the timeline has: one for each population, and for each quantity of a signal.

import { FACTOR } from "./axes.js";
import { sensorFields } from "./fields.js";
import { ranks } from "./layers.js";

export const MOST_LINES = 4;
const HEIGHT = { raster: [64, 2.4], lines: [48, 1], heat: [42, 1] };  // least pixels, share of the rest

/// [{key, kind, output, title, label, unit, channels, least, share, priority}] in the order of the data's way.
export function makeRows(model) {
  const order = ranks(model.resolved);
  const rows = [];
  let colour = 0;
  const outputs = [...model.outputs.values()].sort((a, b) =>
    (order.get(a.node) ?? 1e6) - (order.get(b.node) ?? 1e6) || a.port.localeCompare(b.port));
  const several = (node) => outputs.filter((each) => each.node === node).length > 1;
  for (const output of outputs) {
    const title = several(output.node) && output.port !== "out" ? `${output.node}.${output.port}` : output.node;
    if (output.kind === "spikes") {
      rows.push(row(output.key, "raster", output, { title, number: colour++, priority: 1 }));
    } else {
      rows.push(...signalRows(model, output, title));
    }
  }
  return rows;
}

function row(key, kind, output, more) {
  const [least, share] = HEIGHT[kind];
  return { key, kind, output, least: least * FACTOR, share, priority: 3, ...more };
}

/// A row for each quantity, as lines of different units cannot share an axis.
function signalRows(model, output, title) {
  const node = model.resolved?.nodes?.[output.node] ?? {};
  const width = output.store.width || model.width(output.key);
  const sensor = node.node === "ros_sensor" ? sensorFields(node, width, model.world) : null;
  const command = output.kind === "command" ? model.sent.get(output.node)?.fields : null;
  const fields = (command?.length ? command : sensor) ??
    Array.from({ length: width }, (_, i) => ({ path: width === 1 ? "" : `channel ${i}`, quantity: "value", unit: "" }));
  const priority = command ? 0 : node.node === "ros_sensor" ? 2 : 3;
  if (!fields.length) {
    return [row(output.key, "lines", output, { title, label: "", unit: "", channels: [], priority })];
  }
  const groups = new Map();
  fields.forEach((field, channel) => {
    const name = `${field.quantity}|${field.unit}`;
    groups.set(name, [...(groups.get(name) ?? []), { ...field, channel }]);
  });
  return [...groups.values()].map((channels, number) => {
    const { quantity, unit } = channels[0];
    const lone = channels.length === 1;
    const label = lone && channels[0].path ? channels[0].path : quantity === "value" ? "" : quantity;
    return row(number === 0 ? output.key : `${output.key}:${quantity}`,
               channels.length > MOST_LINES ? "heat" : "lines", output,
               { title, label, unit, channels, priority, command: Boolean(command), beams: beams(node, width, model) });
  });
}

function beams(node, width, model) {
  const laser = model.world?.laser;
  if (!/LaserScan$/.test(node.message ?? "") || !laser || node.beams || width < 2 || width > laser.beams) {
    return null;
  }
  return { first: laser.angle_min_rad * 180 / Math.PI, step: laser.angle_increment_rad * 180 / Math.PI };
}

/// Keys of the rows that fit into so many pixels; those of commands first, then rasters, sensors, the others.
export function fitting(rows, height) {
  const chosen = new Set();
  let left = height;
  for (const each of [...rows].sort((a, b) => a.priority - b.priority)) {
    if (each.least <= left || chosen.size === 0) {
      chosen.add(each.key);
      left -= each.least;
    }
  }
  return chosen;
}
