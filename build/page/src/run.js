// The values of all variables over time, and where in it we stand.

/** Rows that a live run keeps; the older half goes when they are full (ten minutes at 60 Hz). */
const LIVE_ROWS = 36000;

export class Run {
  /**
   * @param {Float64Array} time s, never decreasing
   * @param {Map<string, Float32Array>} columns
   * @param {Set<string>} stepped names of variables that hold their value between rows
   */
  constructor(time, columns, rows, stepped) {
    Object.assign(this, { time, columns, rows, stepped, row: 0, share: 0, now: 0 });
  }

  /** A run to which rows are added. */
  static live(names, stepped) {
    const columns = new Map(names.map((name) => [name, new Float32Array(LIVE_ROWS)]));
    return new Run(new Float64Array(LIVE_ROWS), columns, 0, stepped);
  }

  get start() {
    return this.rows ? this.time[0] : 0;
  }

  get end() {
    return this.rows ? this.time[this.rows - 1] : 0;
  }

  /** Goes to a time: between `row` and the next one, at `share`. */
  locate(time) {
    this.now = Math.min(Math.max(time, this.start), this.end);
    let low = 0;
    let high = this.rows - 1;
    if (high < 1) {
      this.row = this.share = 0;
      return;
    }
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.time[middle] <= this.now) low = middle;
      else high = middle;
    }
    const length = this.time[high] - this.time[low];
    this.row = low;
    this.share = length > 0 ? (this.now - this.time[low]) / length : 1;
  }

  /** The row nearest to where we stand. */
  nearest() {
    return Math.min(this.row + Math.round(this.share), Math.max(this.rows - 1, 0));
  }

  /** Value of a variable now; undefined where it is not known. */
  value(name) {
    const column = this.columns.get(name);
    if (!column || !this.rows) return undefined;
    const before = column[this.row];
    const after = column[Math.min(this.row + 1, this.rows - 1)];
    if (this.share === 1) return defined(after);
    if (this.stepped.has(name) || this.share === 0) return defined(before);
    return defined(before + (after - before) * this.share);
  }

  /** Numbers of a track now: its variables, or their start where they are not known. */
  numbers(track, into) {
    track.start.forEach((start, i) => {
      into[i] = this.value(track.variables[i]) ?? start;
    });
    return into;
  }

  /** A quaternion now. Its sign may differ between two rows, so they are not simply mixed. */
  quaternion(track, into) {
    const next = Math.min(this.row + 1, this.rows - 1);
    const at = (i, row) => {
      const value = this.columns.get(track.variables[i])?.[row];
      return defined(value) ?? track.start[i];
    };
    let dot = 0;
    for (let i = 0; i < 4; i++) dot += at(i, this.row) * at(i, next);
    const sign = dot < 0 ? -1 : 1;
    for (let i = 0; i < 4; i++) {
      into[i] = at(i, this.row) * (1 - this.share) + sign * at(i, next) * this.share;
    }
    const length = Math.hypot(...into);
    return length > 1e-6 ? into.map((x) => x / length) : [0, 0, 0, 1];
  }

  /** Adds a row; a time that goes back begins anew. */
  append(names, time, values) {
    if (this.rows && time < this.end) this.rows = 0;
    if (this.rows && time === this.end) this.rows -= 1;
    if (this.rows === LIVE_ROWS) {
      const half = LIVE_ROWS / 2;
      this.time.copyWithin(0, half);
      for (const column of this.columns.values()) column.copyWithin(0, half);
      this.rows = half;
    }
    this.time[this.rows] = time;
    names.forEach((name, i) => {
      this.columns.get(name)[this.rows] = values[i];
    });
    this.rows += 1;
  }
}

function defined(value) {
  return Number.isFinite(value) ? value : undefined;
}
