// The world from above or from the side: arena, obstacles, lanes, goals, lamps, the robot and its path, the laser's beams.

import { Surface } from "./axes.js";
import { FROM_ABOVE, enter, fitting, floorAt, project } from "./camera.js";
import { keep, kept } from "./choices.js";
import { isShortcut } from "./controls.js";
import { palette } from "./palette.js";
import { drawBeams, drawFloor, drawGrid, drawPlan, drawRobot, drawScale, mounted, tracePath } from "./scene.js";
import { drawSolids, robotPrism, standing } from "./solids.js";
import { counted, fixed, setText } from "./text.js";

const MARGIN = 18;
const OBLIQUE = { azimuth: -0.5, elevation: 0.8 };  // rad
const LOWEST = 0.2, HIGHEST = 1.5;  // elevation
const TURN = 0.008;  // rad a pixel
const LABELS = ["World from above: wheel zooms, drag moves, double click shows everything",
                "World in three dimensions: wheel zooms, drag turns, Shift and drag moves, double click shows everything"];
const START_S = 0.5;  // so long the robot is about where it started, while no path is known

export class WorldPanel {
  constructor(model, trajectory, onChange) {
    this.model = model;
    this.trajectory = trajectory;
    this.panel = document.getElementById("world");
    this.title = this.panel.querySelector("h2 button");
    this.note = document.getElementById("world-note");
    this.picture = document.getElementById("picture");
    this.fitButton = document.getElementById("world-fit");
    this.obliqueButton = document.getElementById("world-3d");
    this.surface = new Surface(document.getElementById("world-canvas"), () => { this.layer = null; onChange(); });
    this.onChange = onChange;
    this.angles = { ...OBLIQUE };
    this.reset();
    this.control(this.surface.canvas);
    this.fitButton.addEventListener("click", () => this.fit());
    this.obliqueButton.addEventListener("click", () => this.setOblique(!this.oblique));
    document.addEventListener("keydown", (event) => {
      if (event.key === "3" && isShortcut(event) && !this.panel.hidden) {
        this.setOblique(!this.oblique);
      }
    });
    this.setOblique(kept("world") === "3d");
  }

  /// In three dimensions, or from above.
  setOblique(oblique) {
    this.oblique = oblique;
    keep("world", oblique ? "3d" : "plan");
    this.obliqueButton.setAttribute("aria-pressed", String(oblique));
    this.surface.canvas.setAttribute("aria-label", LABELS[Number(oblique)]);
    this.fit();
  }

  reset() {
    this.view = null;  // {x, y, scale} as in camera.js; null: everything
    this.layer = null;  // what changes seldom: the world and the path so far
    this.box = null;
  }

  get available() {
    return Boolean(this.model.world?.arena) || this.trajectory.count > 1 || Boolean(this.model.scans.length);
  }

  fit() {
    this.view = null;
    this.changed();
  }

  control(canvas) {
    let last = null;
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      const [x, y] = [event.offsetX, event.offsetY], old = this.current();
      const scale = Math.max(2, Math.min(5000, old.scale * Math.exp(-event.deltaY * 0.0015)));
      const place = [x - this.surface.width / 2, this.surface.height / 2 - y];
      const from = floorAt(old, ...place), to = floorAt({ ...old, scale }, ...place);
      this.view = { scale, x: old.x + from[0] - to[0], y: old.y + from[1] - to[1] };
      this.changed();
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (last) {
        this.move(event.clientX - last[0], event.clientY - last[1], event);
        last = [event.clientX, event.clientY];
      }
    });
    ["pointerup", "pointercancel"].forEach((name) => canvas.addEventListener(name, () => { last = null; }));
    canvas.addEventListener("dblclick", () => this.fit());
    canvas.addEventListener("keydown", (event) => {
      const act = {
        ArrowLeft: () => this.move(40, 0, event), ArrowRight: () => this.move(-40, 0, event),
        ArrowUp: () => this.move(0, 40, event), ArrowDown: () => this.move(0, -40, event), "+": () => this.zoom(1.25), "-": () => this.zoom(0.8),
        Home: () => this.fit(),
      }[event.key];
      if (act) {
        event.preventDefault();
        act();
      }
    });
  }

  /// By pixels. In three dimensions this turns the view, with Shift it moves, too.
  move(right, down, { shiftKey }) {
    if (!right && !down) {
      return;
    }
    if (this.oblique && !shiftKey) {
      const { azimuth, elevation } = this.angles;
      this.angles = { azimuth: azimuth - TURN * right,
                      elevation: Math.max(LOWEST, Math.min(HIGHEST, elevation + TURN * down)) };
    } else {
      const old = this.current(), [x, y] = floorAt(old, -right, down);
      this.view = { scale: old.scale, x, y };
    }
    this.changed();
  }

  zoom(factor) {
    const { x, y, scale } = this.current();
    this.view = { x, y, scale: scale * factor };
    this.changed();
  }

  changed() {
    this.layer = null;
    this.onChange();
  }

  current() {
    const angles = this.oblique ? this.angles : FROM_ABOVE;
    if (this.view) {
      return { ...this.view, ...angles };
    }
    const { width, height } = this.surface, high = this.model.world?.arena?.wall_height_m ?? 0;
    return fitting(this.extent(), high, angles, width - 2 * MARGIN, height - 2 * MARGIN);
  }

  /// [left, bottom, right, top] of the arena, or of the path, which grows in steps.
  extent() {
    const arena = this.model.world?.arena;
    if (arena) {
      return [arena.min_x_m, arena.min_y_m, arena.max_x_m, arena.max_y_m];
    }
    const { trajectory } = this;
    if (this.boxRows > trajectory.count) {
      [this.box, this.boxRows] = [null, 0];
    }
    for (let row = this.boxRows ?? 0; row < trajectory.count; ++row) {
      const [x, y] = [trajectory.x(row), trajectory.y(row)], box = this.box;
      if (!box || x < box[0] || y < box[1] || x > box[2] || y > box[3]) {
        const grow = box ? 0.25 * (box[2] - box[0]) : 1;
        const near = [x - grow, y - grow, x + grow, y + grow];
        this.box = box ? near.map((each, i) => (i < 2 ? Math.min : Math.max)(each, box[i])) : near;
        this.layer = null;
      }
    }
    this.boxRows = trajectory.count;
    return this.box ?? [-2, -2, 2, 2];
  }

  draw() {
    const { surface, model, trajectory } = this;
    if (!surface.begin()) {
      return;
    }
    const view = this.current(), { context, width, height, ratio } = surface;
    this.drawLayer(view, width, height, ratio);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.drawImage(this.layer, 0, 0);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const { live, range } = model.timeline;
    // The path of a recording goes on behind the time that is shown.
    const time = !live ? range[1] : model.recording ? model.timeline.newest : Infinity;
    this.pose = trajectory.count ? trajectory.pose(time) : this.startPose();
    enter(context, view, width, height);
    if (this.pose) {
      this.drawRecent(context, view, live ? this.pose.t - (range[1] - range[0]) : range[0], this.pose.t);
      this.drawScan(context, view);
    }
    const radius = model.world?.vehicle_radius_m ?? 14 / view.scale;
    if (this.pose && !this.oblique) {
      drawRobot(context, view, this.pose, radius);
    }
    this.placePicture(view);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (this.oblique) {
      this.drawSolids(view, radius);
    }
    drawScale(context, view, height);
    this.fitButton.hidden = !this.view;
    setText(this.note, this.pose && trajectory.count ? this.describe(live) : "");
  }

  drawSolids(view, radius) {
    const world = this.model.world ?? {}, solids = standing(world);
    if (this.pose) {
      solids.push(robotPrism(view, this.pose, radius, world.vehicle_height_m ?? 0));
    }
    drawSolids(this.surface, view, world, solids);
  }

  describe(live) {
    const { x, y, theta, t } = this.pose, { collisions } = this.trajectory;
    return [collisions > 0 ? counted(collisions, "collision") : "", live ? "" : `at ${fixed(t, 2)} s`,
            `x ${fixed(x, 2)} m`, `y ${fixed(y, 2)} m`, `${fixed(theta * 180 / Math.PI, 0)}°`].filter(Boolean).join("   ");
  }

  /// The picture of the camera stands where the robot is not.
  placePicture(view) {
    if (this.pose) {
      const [right, up] = project(view, this.pose.x, this.pose.y), below = -up;
      const old = this.picture.dataset.corner, limit = 0.08 * this.surface.width;
      if (old === "right" ? right > limit && below > -limit : right < -limit || below < -3 * limit) {
        this.picture.dataset.corner = old === "right" ? "left" : "right";
      }
    }
  }

  startPose() {
    const start = this.model.world?.start;
    const begun = this.model.timeline.newest > START_S;
    return start && !begun ? { t: 0, x: start.x_m, y: start.y_m, theta: start.theta_rad } : null;
  }

  drawLayer(view, width, height, ratio) {
    const { trajectory } = this;
    const key = [width, height, ratio, palette.dark, trajectory.thinned, Boolean(this.model.world)].join();
    if (!this.layer || this.layerKey !== key) {
      this.layerKey = key;
      this.layer = document.createElement("canvas");
      [this.layer.width, this.layer.height] = [Math.round(width * ratio), Math.round(height * ratio)];
      this.drawnRows = 0;
      const context = this.layer.getContext("2d");
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      enter(context, view, width, height);
      this.drawGround(context, view, this.model.world ?? {});
    }
    if (trajectory.count > this.drawnRows) {
      const context = this.layer.getContext("2d");
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      enter(context, view, width, height);
      const rows = [Math.max(0, this.drawnRows - 1), trajectory.count - 1];
      tracePath(context, view, trajectory, rows, 1.5, palette.groups[4]);
      this.drawnRows = trajectory.count;
    }
  }

  /// What the path lies on.
  drawGround(context, view, world) {
    if (this.oblique && world.arena) {
      drawGrid(context, view, world.arena);
    }
    drawFloor(context, view, world);
    if (!this.oblique) {
      drawPlan(context, view, world);
    }
  }

  /// The part of the path that lies on the time axis.
  drawRecent(context, view, from, to) {
    const { trajectory } = this;
    if (trajectory.count) {
      const rows = [Math.max(0, trajectory.find(from)), trajectory.find(to)];
      tracePath(context, view, trajectory, rows, 2.6, palette.path);
    }
  }

  /// The newest scan of the time that is shown.
  drawScan(context, view) {
    const { scans, timeline, world } = this.model;
    const until = timeline.live ? this.pose.t : timeline.range[1];
    const found = scans.findLast((each) => each.seconds <= until + 1e-6) ?? (timeline.live ? scans[0] : null);
    if (found) {
      const robot = this.trajectory.pose(found.seconds) ?? this.pose;
      drawBeams(context, view, found.scan, mounted(robot, world?.laser));
    }
  }
}
