// The robot's path: trajectory.csv, which grows while the robot moves, read piece by piece.

import { lastAtOrBefore } from "./search.js";

const POLL_MS = 100;
const IDLE_MS = 2000;
const MOST_ROWS = 200_000;
const COLUMNS = 4;  // t, x, y, theta

export class Trajectory {
  constructor() {
    this.reset();
  }

  reset() {
    this.generation = (this.generation ?? 0) + 1;
    this.position = 0;  // bytes that were read
    this.rest = "";
    this.rows = new Float64Array(COLUMNS * 1024);
    this.count = 0;
    this.collisions = NaN;
    this.thinned = (this.thinned ?? 0) + 1;  // grows when rows were replaced
  }

  /// `moving()` tells whether there can be something new in the file.
  start(moving) {
    const poll = async () => {
      let wait = POLL_MS;
      try {
        if (moving() && !await this.read()) {
          wait = IDLE_MS;
        }
      } catch {
        // no server: the connection says so
      }
      setTimeout(poll, wait);
    };
    poll();
  }

  /// False if there is no file.
  async read() {
    const generation = this.generation;
    const headers = this.position > 0 ? { Range: `bytes=${this.position}-` } : {};
    const answer = await fetch("/run/trajectory.csv", { headers, cache: "no-store" });
    if (answer.status === 416 || answer.status === 204) {
      return true;
    }
    if (!answer.ok) {
      return false;
    }
    const bytes = new Uint8Array(await answer.arrayBuffer());
    if (generation !== this.generation) {
      return true;  // of the run before
    }
    if (answer.status === 200 && this.position > 0) {
      this.reset();
    }
    this.position += bytes.length;
    this.add(new TextDecoder().decode(bytes));
    return true;
  }

  add(text) {
    const lines = (this.rest + text).split("\n");
    this.rest = lines.pop();
    for (const line of lines) {
      const cells = line.split(",").map(Number);
      if (cells.length < COLUMNS || cells.slice(0, COLUMNS).some(Number.isNaN)) {
        continue;  // the header
      }
      if (COLUMNS * (this.count + 1) > this.rows.length) {
        this.makeRoom();
      }
      this.rows.set(cells.slice(0, COLUMNS), COLUMNS * this.count);
      this.count += 1;
      this.collisions = cells[6] ?? NaN;
    }
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
