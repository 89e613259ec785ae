// Search in rows that are sorted by time.

/// The last row of [low, high) at or before `seconds`, by rows.time(row); low - 1 if there is none.
export function lastAtOrBefore(rows, low, high, seconds) {
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (rows.time(middle) <= seconds) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low - 1;
}
