// The time axis that all rasters and signals share: the newest seconds, or a part of the past.

const LEAST_S = 0.02;
const MOST_S = 120;

export class Timeline {
  constructor() {
    this.listeners = [];
    this.reset();
  }

  reset() {
    this.span = 2;
    this.fixedEnd = null;  // null: live
    this.newest = 0;
  }

  /// The newest data are forgotten; the span is the user's.
  rewind() {
    this.fixedEnd = null;
    this.newest = 0;
  }

  onChange(listener) {
    this.listeners.push(listener);
  }

  changed() {
    this.listeners.forEach((listener) => listener());
  }

  get live() {
    return this.fixedEnd === null;
  }

  /// [from, to] in seconds of simulated time. A run that has just begun fills the axis from the left.
  get range() {
    const end = Math.max(this.fixedEnd ?? this.newest, this.span);
    return [end - this.span, end];
  }

  advance(seconds) {
    if (seconds > this.newest) {
      this.newest = seconds;
      return true;
    }
    return false;
  }

  /// at: 0 is the left edge, 1 the right one, which is kept while live.
  zoom(factor, at = 1) {
    const [from] = this.range;
    const span = Math.min(MOST_S, Math.max(LEAST_S, this.span * factor));
    if (!this.live) {
      this.fixedEnd = from + at * this.span + (1 - at) * span;
      this.settle(span);
    }
    this.span = span;
    this.changed();
  }

  pan(seconds) {
    const [, end] = this.range;
    this.fixedEnd = Math.max(this.span, end + seconds);
    this.settle(this.span);
    this.changed();
  }

  /// Past the newest data the axis is live again.
  settle() {
    if (this.fixedEnd >= this.newest) {
      this.fixedEnd = null;
    }
  }

  goLive() {
    this.fixedEnd = null;
    this.changed();
  }

  /// Wheel, drag, double click and keys on an element. inset(): [left, right] pixels outside of the axis.
  control(element, inset) {
    const width = () => Math.max(1, element.clientWidth - inset()[0] - inset()[1]);
    const place = (event) => (event.clientX - element.getBoundingClientRect().left - inset()[0]) / width();
    element.addEventListener("wheel", (event) => {
      if (event.ctrlKey || event.shiftKey) {
        return;  // the browser's zoom; scrolling of the list
      }
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * 0.002))), Math.min(1, Math.max(0, place(event))));
    }, { passive: false });
    let last = null;
    element.addEventListener("pointerdown", (event) => {
      const onScrollbar = event.target === element && event.offsetX > element.clientWidth;
      if (event.button === 0 && !onScrollbar) {
        last = event.clientX;
        element.setPointerCapture(event.pointerId);
      }
    });
    element.addEventListener("pointermove", (event) => {
      if (last !== null && Math.abs(event.clientX - last) > 1) {
        this.pan(-(event.clientX - last) / width() * this.span);
        last = event.clientX;
      }
    });
    for (const name of ["pointerup", "pointercancel"]) {
      element.addEventListener(name, () => { last = null; });
    }
    element.addEventListener("dblclick", () => this.goLive());
    element.addEventListener("keydown", (event) => {
      const act = {
        ArrowLeft: () => this.pan(-0.1 * this.span), ArrowRight: () => this.pan(0.1 * this.span),
        "+": () => this.zoom(0.8), "-": () => this.zoom(1.25), Home: () => this.goLive(), End: () => this.goLive(),
      }[event.key];
      if (act && event.target === element) {
        event.preventDefault();
        act();
      }
    });
  }
}
