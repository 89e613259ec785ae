// Prisms above the floor, drawn from far to near: obstacles, walls, lamps, the robot.
//
// A prism: {base: [[x, y], ...] convex and counterclockwise, height (m), colour, crown(context)}. `crown`, if there is
// one, draws on its top, in the units of camera.js's enter().

import { enter, project, toViewer } from "./camera.js";
import { palette, shade } from "./palette.js";
import { drawRobot, star } from "./scene.js";

const WALL_M = 0.1;  // thickness of the walls; world.json has their inner faces only
const LAMP_M = 0.04;  // radius of a lamp that no obstacle holds
const ROUND = 32;  // corners in place of a circle
const FEW = 8;  // corners; edges between more faces are not drawn
const NEAR_WALL = 0.3;  // opacity of walls in front of the room
const TOUCH = 1e-9;  // m

/// Obstacles and lamps. Those without a height (of earlier versions) lie on the floor.
export function standing(world) {
  const obstacles = world.obstacles ?? [], lamps = world.lamps ?? [];
  const holds = (obstacle, lamp) => Math.hypot(obstacle.x_m - lamp.x_m, obstacle.y_m - lamp.y_m) < TOUCH;
  const alone = lamps.filter((lamp) => !obstacles.some((each) => holds(each, lamp)));
  return [
    ...obstacles.map((each) => ({
      base: footprint(each), height: each.height_m ?? 0,
      colour: lamps.some((lamp) => holds(each, lamp)) ? palette.lamp : palette.fill,
    })),
    ...alone.map((lamp) => ({ base: circle(lamp.x_m, lamp.y_m, LAMP_M), height: lamp.height_m ?? 0,
                              colour: palette.lamp })),
  ];
}

/// The vehicle: a disc with an arrow on it.
export function robotPrism(view, pose, radius, height) {
  const crown = (context) => drawRobot(context, view, pose, radius);
  return { base: circle(pose.x, pose.y, radius), height, colour: palette.plot, side: palette.path, crown };
}

/// Four walls around the arena, each with `near`: it stands between the viewer and the room.
function walls({ min_x_m: left, min_y_m: low, max_x_m: right, max_y_m: top, wall_height_m: height }, view) {
  const inner = [[left, low], [right, low], [right, top], [left, top]];
  const outer = [[left - WALL_M, low - WALL_M], [right + WALL_M, low - WALL_M], [right + WALL_M, top + WALL_M],
                 [left - WALL_M, top + WALL_M]];
  const outwards = [[0, -1], [1, 0], [0, 1], [-1, 0]];
  return inner.map((corner, i) => {
    const next = (i + 1) % 4;
    return { base: [outer[i], outer[next], inner[next], corner], height, colour: palette.wallTop,
             near: dot(outwards[i], toViewer(view)) > 0 };
  });
}

/// surface: {context, width, height}, its unit the pixel. solids: without the walls.
export function drawSolids(surface, view, world, solids) {
  const { context } = surface;
  const around = world.arena?.wall_height_m > 0 ? walls(world.arena, view) : [];
  around.filter((wall) => !wall.near).forEach((wall) => drawPrism(surface, view, wall));
  fromFarToNear(solids, view).forEach((solid) => drawPrism(surface, view, solid));
  for (const { x_m: x, y_m: y, height_m: height } of world.lamps ?? []) {
    const [right, up] = project(view, x, y, height ?? 0);
    context.save();
    context.translate(surface.width / 2 + right, surface.height / 2 - up);
    context.scale(1, -1);
    star(context, 0, 0, 9);
    context.restore();
  }
  context.globalAlpha = NEAR_WALL;
  around.filter((wall) => wall.near).forEach((wall) => drawPrism(surface, view, wall));
  context.globalAlpha = 1;
}

function drawPrism({ context, width, height }, view, { base, height: top, colour, side = colour, crown }) {
  const viewer = toViewer(view);
  // From the left, so that neighbouring faces differ.
  const light = [0.75 * viewer[0] + 0.66 * viewer[1], 0.75 * viewer[1] - 0.66 * viewer[0]];
  const place = ([x, y], z) => {
    const [right, up] = project(view, x, y, z);
    return [width / 2 + right, height / 2 - up];
  };
  context.lineJoin = "round";
  context.lineWidth = 1;
  base.forEach((from, i) => {
    const to = base[(i + 1) % base.length], normal = outward(from, to);
    if (dot(normal, viewer) > 0 && top > 0) {
      const fill = shade(side, 0.58 + 0.3 * Math.max(0, dot(normal, light)));
      outline(context, [place(from, 0), place(to, 0), place(to, top), place(from, top)]);
      paint(context, fill, base.length > FEW ? fill : palette.soft);
    }
  });
  outline(context, base.map((corner) => place(corner, top)));
  paint(context, colour, palette.soft);
  if (crown) {
    context.save();
    enter(context, view, width, height, top);
    crown(context);
    context.restore();
  }
}

function outline(context, places) {
  context.beginPath();
  places.forEach(([x, y]) => context.lineTo(x, y));
  context.closePath();
}

function paint(context, fill, edge) {
  context.fillStyle = fill;
  context.fill();
  context.strokeStyle = edge;
  context.stroke();
}

/// What hides others comes behind them. Upright prisms that do not overlap can always be sorted so: the order along
/// one direction of disjoint convex shapes has no cycles. Of those that overlap the one whose middle is nearer hides.
export function fromFarToNear(solids, view) {
  const viewer = toViewer(view), all = solids.map((solid) => measured(solid.base, viewer));
  const hiding = all.map((a, i) => new Set(all.flatMap((b, k) => (k !== i && isNearer(b, a, viewer) ? [k] : []))));
  const waiting = new Set(solids.keys()), sorted = [];
  while (waiting.size) {
    // One that hides nothing that waits. With overlaps there may be a cycle: then any.
    const next = [...waiting].find((i) => ![...waiting].some((k) => hiding[k].has(i))) ?? [...waiting][0];
    waiting.delete(next);
    sorted.push(solids[next]);
  }
  return sorted;
}

/// A base with its extent across the view, and how near its middle is to the viewer.
function measured(base, viewer) {
  const across = base.map(([x, y]) => y * viewer[0] - x * viewer[1]);
  const near = base.reduce((sum, corner) => sum + dot(corner, viewer), 0) / base.length;
  return { base, near, left: Math.min(...across), right: Math.max(...across) };
}

/// Whether a can hide a part of b: they overlap across the view, and a stands on the viewer's side of a line between.
function isNearer(a, b, viewer) {
  if (a.right <= b.left || b.right <= a.left) {
    return false;
  }
  const side = separation(a.base, b.base, viewer) ?? -(separation(b.base, a.base, viewer) ?? NaN);
  return Number.isNaN(side) ? a.near > b.near : side < 0;
}

/// If an edge of a has all of b outside: above 0 if b is on the viewer's side of it, below 0 if on the other one.
function separation(a, b, viewer) {
  for (let i = 0; i < a.length; ++i) {
    const normal = outward(a[i], a[(i + 1) % a.length]), edge = dot(normal, a[i]), side = dot(normal, viewer);
    if (Math.abs(side) > TOUCH && b.every((corner) => dot(normal, corner) >= edge - TOUCH)) {
      return side;
    }
  }
  return null;
}

function footprint({ shape, x_m: x, y_m: y, theta_rad: theta, ...size }) {
  if (shape === "cylinder") {
    return circle(x, y, size.radius_m);
  }
  const [cos, sin] = [Math.cos(theta ?? 0), Math.sin(theta ?? 0)];
  return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([i, k]) => {
    const [right, up] = [i * size.half_x_m, k * size.half_y_m];
    return [x + cos * right - sin * up, y + sin * right + cos * up];
  });
}

function circle(x, y, radius) {
  return Array.from({ length: ROUND }, (_, i) => {
    const angle = (2 * Math.PI * i) / ROUND;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

/// Normal of an edge of a counterclockwise base.
function outward([x, y], [x2, y2]) {
  const length = Math.hypot(x2 - x, y2 - y) || 1;
  return [(y2 - y) / length, (x - x2) / length];
}

function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1];
}
