// Draws what the world has on its floor, and all of it as a plan, in metres: x to the right, y up.

import { FONT } from "./axes.js";
import { palette } from "./palette.js";
import { short } from "./text.js";

const TAU = 2 * Math.PI;
const LASER_X_M = 0.1;  // of Spikeloop's robot, in front of its centre (docs/robot.md)
const MOST_LINES = 50;  // of the floor, in a direction
const SCALE_X = 18, SCALE_MOST = 110;  // pixels: the bar's place and longest length

/// Pose of the laser on the robot.
export function mounted({ x, y, theta }, laser) {
  const forward = laser ? laser.x_m ?? LASER_X_M : 0, left = laser?.y_m ?? 0;
  const [cos, sin] = [Math.cos(theta), Math.sin(theta)];
  return { x: x + forward * cos - left * sin, y: y + forward * sin + left * cos,
           theta: theta + (laser?.theta_rad ?? 0) };
}

/// Beams from the laser to what they meet.
export function drawBeams(context, view, scan, at) {
  const ends = [];
  scan.ranges.forEach((range, i) => {
    const far = !(range < scan.range_max);
    if (Number.isNaN(range) || range < scan.range_min) {
      return;
    }
    const angle = at.theta + scan.angle_min + i * scan.angle_increment, length = far ? scan.range_max : range;
    ends.push([at.x + length * Math.cos(angle), at.y + length * Math.sin(angle), far]);
  });
  if (!ends.length) {
    return;
  }
  context.fillStyle = palette.beam;
  context.strokeStyle = palette.beam;
  context.globalAlpha = palette.dark ? 0.1 : 0.14;
  context.beginPath();
  context.moveTo(at.x, at.y);
  ends.forEach(([x, y]) => context.lineTo(x, y));
  context.fill();
  context.globalAlpha = 0.35;
  context.lineWidth = 0.7 / view.scale;
  context.beginPath();
  const stride = Math.max(1, Math.round(ends.length / 50));
  for (let i = 0; i < ends.length; i += stride) {
    context.moveTo(at.x, at.y);
    context.lineTo(ends[i][0], ends[i][1]);
  }
  context.stroke();
  context.globalAlpha = 1;
  context.fillStyle = palette.hit;
  const size = 2.4 / view.scale;
  ends.forEach(([x, y, far]) => far || context.fillRect(x - size / 2, y - size / 2, size, size));
}

/// Lanes and goals.
export function drawFloor(context, view, world) {
  const line = 1 / view.scale;
  for (const lane of world.lanes ?? []) {
    footprint(context, lane, palette.none, palette.none, 0);
  }
  for (const goal of world.goals ?? []) {
    context.setLineDash([5 * line, 3 * line]);
    footprint(context, goal, palette.goal, palette.goalEdge, 1.2 * line);
    context.setLineDash([]);
  }
}

/// Lines a metre apart: what lies obliquely is seen as a floor.
export function drawGrid(context, view, { min_x_m: left, min_y_m: low, max_x_m: right, max_y_m: top }) {
  const step = Math.max(1, Math.ceil(Math.max(right - left, top - low) / MOST_LINES));
  context.strokeStyle = palette.grid;
  context.lineWidth = 1 / view.scale;
  context.beginPath();
  for (let x = Math.ceil(left / step) * step; x <= right; x += step) {
    context.moveTo(x, low);
    context.lineTo(x, top);
  }
  for (let y = Math.ceil(low / step) * step; y <= top; y += step) {
    context.moveTo(left, y);
    context.lineTo(right, y);
  }
  context.stroke();
}

/// Obstacles, lamps and walls from above.
export function drawPlan(context, view, world) {
  const line = 1 / view.scale;
  for (const obstacle of world.obstacles ?? []) {
    footprint(context, obstacle, palette.fill, palette.soft, line);
  }
  for (const lamp of world.lamps ?? []) {
    star(context, lamp.x_m, lamp.y_m, 9 * line);
  }
  const { arena } = world;
  if (arena) {
    context.strokeStyle = palette.wall;
    context.lineWidth = 2.5 * line;
    context.strokeRect(arena.min_x_m, arena.min_y_m, arena.max_x_m - arena.min_x_m, arena.max_y_m - arena.min_y_m);
  }
}

function footprint(context, { shape, x_m: x, y_m: y, ...size }, fill, edge, width) {
  context.save();
  context.translate(x, y);
  context.rotate(size.theta_rad ?? 0);
  context.beginPath();
  if (shape === "cylinder") {
    context.arc(0, 0, size.radius_m, 0, TAU);
  } else {
    context.rect(-size.half_x_m, -size.half_y_m, 2 * size.half_x_m, 2 * size.half_y_m);
  }
  context.fillStyle = fill;
  context.fill();
  if (width > 0) {  // a canvas takes no line width of 0
    context.strokeStyle = edge;
    context.lineWidth = width;
    context.stroke();
  }
  context.restore();
}

export function star(context, x, y, size) {
  context.beginPath();
  for (let i = 0; i < 10; ++i) {
    const angle = Math.PI / 2 + (i * Math.PI) / 5, radius = i % 2 ? 0.45 * size : size;
    context.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
  }
  context.closePath();
  context.fillStyle = palette.lamp;
  context.fill();
  context.strokeStyle = palette.ink;
  context.lineWidth = 0.12 * size;
  context.stroke();
}

/// Rows first to last of the path. It is interrupted where the robot was put elsewhere, as at the begin of an episode.
export function tracePath(context, view, trajectory, [first, last], width, colour) {
  context.strokeStyle = colour;
  context.lineWidth = width / view.scale;
  context.lineJoin = context.lineCap = "round";
  context.beginPath();
  for (let row = first; row <= last; ++row) {
    if (row > first && trajectory.jumps(row)) {
      context.moveTo(trajectory.x(row), trajectory.y(row));
    } else {
      context.lineTo(trajectory.x(row), trajectory.y(row));
    }
  }
  context.stroke();
}

export function drawRobot(context, view, { x, y, theta }, radius) {
  context.save();
  context.translate(x, y);
  context.rotate(theta);
  context.beginPath();
  context.arc(0, 0, radius, 0, TAU);
  context.fillStyle = palette.plot;
  context.globalAlpha = 0.85;
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = palette.ink;
  context.lineWidth = 1.8 / view.scale;
  context.stroke();
  context.beginPath();  // an arrow head: where is front
  context.moveTo(0.8 * radius, 0);
  context.lineTo(-0.5 * radius, 0.52 * radius);
  context.lineTo(-0.22 * radius, 0);
  context.lineTo(-0.5 * radius, -0.52 * radius);
  context.closePath();
  context.fillStyle = palette.ink;
  context.fill();
  context.restore();
}

/// A bar of a round number of metres.
export function drawScale(context, view, height) {
  const most = SCALE_MOST / view.scale, power = 10 ** Math.floor(Math.log10(most));
  const length = power * [5, 2, 1].find((step) => step * power <= most);
  const pixels = length * view.scale, y = height - 5.5;
  context.strokeStyle = palette.soft;
  context.lineWidth = 1;
  context.beginPath();
  context.moveTo(SCALE_X + 0.5, y - 4);
  context.lineTo(SCALE_X + 0.5, y);
  context.lineTo(SCALE_X + pixels + 0.5, y);
  context.lineTo(SCALE_X + pixels + 0.5, y - 4);
  context.stroke();
  context.font = FONT;
  context.fillStyle = palette.soft;
  context.textAlign = "left";
  context.textBaseline = "bottom";
  context.fillText(`${short(length)} m`, SCALE_X + pixels + 6, y + 4);
}
