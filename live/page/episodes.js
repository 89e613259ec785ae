// The episodes of a task that have ended: episodes.csv of the run folder (docs/episodes.md).

import { GrowingTable } from "./growing.js";
import { lastAtOrBefore } from "./search.js";

const COLUMNS = ["episode", "begin_s", "end_s", "steps", "return", "success"];  // then the reason of the end

export class Episodes {
  constructor() {
    this.table = new GrowingTable("/run/episodes.csv", { add: (row) => this.add(row), clear: () => this.clear() });
  }

  clear() {
    this.rows = [];  // {number, end, total, success}
  }

  add(row) {
    const [number, , end, , total, success] = row.slice(0, COLUMNS.length).map(Number);
    if (row.length > COLUMNS.length && !Number.isNaN(number)) {  // not the header
      this.rows.push({ number, end, total, success: success === 1 });
    }
  }

  time(row) {
    return this.rows[row].end;
  }

  /// The number of those that had ended at a time.
  endedBy(seconds) {
    return lastAtOrBefore(this, 0, this.rows.length, seconds) + 1;
  }
}
