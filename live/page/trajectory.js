// The robot's path: trajectory.csv, which grows while the robot moves.

import { GrowingTable } from "./growing.js";
import { lastAtOrBefore } from "./search.js";

const MOST_ROWS = 200_000;
const COLUMNS = 4;  // t, x, y, theta
const FASTEST_M_S = 10;  // of a robot

export class Trajectory {
  constructor() {
    this.table = new GrowingTable("/run/trajectory.csv", { add: (row) => this.add(row), clear: () => this.clear() });
  }

  reset() {
    this.table.restart();
  }

  clear() {
    this.rows = new Float64Array(COLUMNS * 1024);
    this.count = 0;
    this.collisions = NaN;
    this.thinned = (this.thinned ?? 0) + 1;  // grows when rows were replaced
  }

  add(row) {
    const cells = row.map(Number);
    if (cells.length < COLUMNS || cells.slice(0, COLUMNS).some(Number.isNaN)) {
      return;  // the header
    }
    if (COLUMNS * (this.count + 1) > this.rows.length) {
      this.makeRoom();
    }
    this.rows.set(cells.slice(0, COLUMNS), COLUMNS * this.count);
    this.count += 1;
    this.collisions = cells[6] ?? NaN;
  }

  makeRoom() {
    if (this.count < MOST_ROWS) {
      const larger = new Float64Array(2 * this.rows.length);
      larger.set(this.rows);
      this.rows = larger;
      return;
    }
    const half = Math.floor(this.count / 2);  // every second row of a long path is enough
    for (let i = 0; i < half; ++i) {
      this.rows.copyWithin(COLUMNS * i, COLUMNS * 2 * i, COLUMNS * (2 * i + 1));
    }
    this.count = half;
    this.thinned += 1;
  }

  x(row) {
    return this.rows[COLUMNS * row + 1];
  }

  y(row) {
    return this.rows[COLUMNS * row + 2];
  }

  time(row) {
    return this.rows[COLUMNS * row];
  }

  /// Whether the robot was put there, and did not move there from the row before.
  jumps(row) {
    const [before, now] = [row - 1, row];
    const way = Math.hypot(this.x(now) - this.x(before), this.y(now) - this.y(before));
    return way > FASTEST_M_S * (this.time(now) - this.time(before));
  }

  /// Last row at or before a time; -1 before the first one.
  find(seconds) {
    return lastAtOrBefore(this, 0, this.count, seconds);
  }

  /// {t, x, y, theta} at a time, or null.
  pose(seconds) {
    if (this.count === 0) {
      return null;
    }
    const row = Math.min(this.count - 1, Math.max(0, this.find(seconds)));
    const [t, x, y, theta] = this.rows.subarray(COLUMNS * row, COLUMNS * (row + 1));
    if (row + 1 === this.count || seconds <= t) {
      return { t, x, y, theta };
    }
    const [t2, x2, y2, theta2] = this.rows.subarray(COLUMNS * (row + 1), COLUMNS * (row + 2));
    const part = (seconds - t) / (t2 - t), turn = theta2 - theta;
    return { t: seconds, x: x + part * (x2 - x), y: y + part * (y2 - y),
             theta: theta + part * Math.atan2(Math.sin(turn), Math.cos(turn)) };
  }
}
