// Plots over time with one cursor for all of them.
import uPlot from "uplot";
import { color, element, short, unit } from "./dom.js";
import { shortNames } from "./defaults.js";

/** Colours that are told apart without telling red from green; from the ninth on with dashes. */
const COLORS = {
  dark: ["#58a6ff", "#f0883e", "#56d39b", "#d2a8ff", "#f2cc60", "#ff7b9c", "#76e3ea", "#b9c4d0"],
  light: ["#0a62c4", "#b34d08", "#0f7553", "#7a3fc4", "#806000", "#c3265b", "#0b6e80", "#4a5565"],
};

const HEIGHT = 132;

/** Seconds that a live plot shows. */
const LIVE_WINDOW = 10;

/** The lowest and the highest value of each pixel column: what a plot can show, and no more. */
function thin(time, columns, from, to, pixels) {
  if (to - from <= 4 * pixels) {
    return [time.subarray(from, to), ...columns.map((column) => column.subarray(from, to))];
  }
  const kept = [];
  for (let pixel = 0; pixel < pixels; pixel++) {
    const first = from + Math.floor(((to - from) * pixel) / pixels);
    const last = from + Math.floor(((to - from) * (pixel + 1)) / pixels);
    const rows = new Set(pixel === 0 ? [first] : []);
    for (const column of columns) {
      let low = first;
      let high = first;
      for (let row = first; row < last; row++) {
        if (column[row] < column[low]) low = row;
        if (column[row] > column[high]) high = row;
      }
      rows.add(low).add(high);
    }
    kept.push(...[...rows].sort((a, b) => a - b));
  }
  kept.push(to - 1);
  return [time, ...columns].map((column) => Float64Array.from(kept, (row) => column[row]));
}

function range(_, low, high) {
  if (low === null || !Number.isFinite(low)) return [0, 1];
  const size = Math.max(Math.abs(low), Math.abs(high));
  const margin = 0.08 * Math.max(high - low, size * 1e-3, 1e-6);
  return [low - margin, high + margin];
}

class Plot {
  constructor(plots, { title, unit: name, names }) {
    Object.assign(this, { plots, names });
    this.title = title;
    this.chart = element("div", { className: "chart" });
    this.key = element("div", { className: "key" });
    this.node = element("figure", { className: "plot", "aria-label": `${title}, over time` },
      element("figcaption", {}, element("b", { textContent: title }),
        element("span", { textContent: unit(name) })),
      this.chart, this.key);
    plots.host.append(this.node);
    this.draw();
  }

  /** Makes the chart, in the colours of the theme. */
  draw() {
    const { plots, names } = this;
    const colors = COLORS[plots.theme];
    const [dim, line] = [color("dim"), color("line")];
    this.chart.replaceChildren();
    this.u?.destroy();
    const axis = { stroke: dim, grid: { stroke: line, width: 1 }, ticks: { show: false },
      font: "11px system-ui, sans-serif", gap: 4, values: (_, list) => list.map(short) };
    this.u = new uPlot({
      width: this.#width(),
      height: HEIGHT,
      legend: { show: false },
      pxAlign: false,
      cursor: {
        sync: { key: "run", setSeries: false },
        drag: { x: true, y: false, dist: 6, setScale: false },
        points: { size: 5 },
        bind: { dblclick: () => () => plots.zoom(null) },
      },
      scales: { x: { time: false }, y: { range } },
      axes: [{ ...axis, size: 22 }, { ...axis, size: 48 }],
      series: [{}, ...names.map((label, i) => ({
        label,
        stroke: colors[i % colors.length],
        width: 1.5,
        points: { show: false },
        dash: i >= colors.length ? [5, 4] : undefined,
      }))],
      hooks: { setSelect: [(u) => this.#selected(u)] },
    }, this.#data(), this.chart);
    this.now = element("div", { className: "now" });
    this.u.over.append(this.now);
    this.u.over.addEventListener("mousedown", () => {
      this.plots.pressed = this;
    });
    this.u.over.addEventListener("click", ({ offsetX }) => {
      if (this.dragged) this.dragged = false;
      else plots.seek(this.u.posToVal(offsetX, "x"));
    });
    const labels = shortNames(names);
    this.values = names.map(() => element("b", { textContent: "–" }));
    this.key.replaceChildren(...names.map((name, i) => {
      const mark = element("i");
      mark.style.background = colors[i % colors.length];
      return element("span", { title: name }, mark, names.length > 1 ? `${labels[i]} ` : "",
        this.values[i]);
    }));
    this.fit();
  }

  #selected(u) {
    const { left, width } = u.select;
    if (width < 6) return;
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    // Plots with one cursor have one selection, too; the one that it was made in decides.
    if (this.plots.pressed !== this) return;
    this.dragged = true;
    this.plots.zoom([u.posToVal(left, "x"), u.posToVal(left + width, "x")]);
  }

  #width() {
    return Math.max(this.node.clientWidth, 200);
  }

  #data() {
    const { run } = this.plots;
    const [from, to] = this.plots.window();
    let first = 0;
    while (first < run.rows && run.time[first] < from) first += 1;
    let last = run.rows;
    while (last > first && run.time[last - 1] > to) last -= 1;
    // One row more on either side, so that lines reach the edge.
    first = Math.max(first - 1, 0);
    last = Math.min(last + 1, run.rows);
    const columns = this.names.map((name) => run.columns.get(name));
    return thin(run.time, columns, first, last, this.#width());
  }

  /** Shows the window of all plots with the data that is there now. */
  fit() {
    const [min, max] = this.plots.window();
    this.u.batch(() => {
      this.u.setData(this.#data(), false);
      this.u.setScale("x", { min, max: Math.max(max, min + 1e-3) });
    });
  }

  resize() {
    if (this.#width() === this.u.width) return;
    this.u.setSize({ width: this.#width(), height: HEIGHT });
    this.fit();
  }

  /** Moves the line of the present time, and writes the values there. */
  tick() {
    const { run } = this.plots;
    const x = this.u.valToPos(run.now, "x");
    const inside = x >= -1 && x <= this.u.over.clientWidth + 1;
    this.now.style.display = inside ? "" : "none";
    this.now.style.transform = `translateX(${x}px)`;
    this.names.forEach((name, i) => {
      this.values[i].textContent = short(run.value(name));
    });
  }

  seen() {
    const { top, bottom } = this.node.getBoundingClientRect();
    return bottom > 0 && top < innerHeight && bottom > top;
  }
}

export class Plots {
  /** @param seek goes to a time */
  constructor(host, run, { live, seek, theme }) {
    Object.assign(this, { host, run, live, seek, theme, zoomed: null, list: [] });
  }

  /** From when to when is shown. */
  window() {
    if (this.zoomed) return this.zoomed;
    const { start, end } = this.run;
    return this.live ? [Math.max(start, end - LIVE_WINDOW), Math.max(end, LIVE_WINDOW)]
      : [start, end];
  }

  add(plot) {
    if (!plot.names.length) return;
    this.list.push(new Plot(this, plot));
  }

  /** Takes the plot of one variable away. */
  remove(name) {
    const gone = this.list.find((plot) => plot.names.length === 1 && plot.names[0] === name);
    gone?.u.destroy();
    gone?.node.remove();
    this.list = this.list.filter((plot) => plot !== gone);
  }

  has(name) {
    return this.list.some((plot) => plot.names.length === 1 && plot.names[0] === name);
  }

  /** Shows a part of the time in all plots; null shows all of it. */
  zoom(window) {
    this.zoomed = window;
    for (const plot of this.list) plot.fit();
  }

  /** Shows `factor` of the time that is shown, about the present. */
  scale(factor) {
    const [from, to] = this.window();
    const { start, end, now } = this.run;
    const length = Math.max((to - from) * factor, 1e-3);
    if (length >= end - start) return this.zoom(null);
    const first = Math.min(Math.max(now - length / 2, start), end - length);
    return this.zoom([first, first + length]);
  }

  retheme(theme) {
    this.theme = theme;
    for (const plot of this.list) plot.draw();
  }

  resize() {
    for (const plot of this.list) plot.resize();
  }

  /** @param grown whether there are new rows */
  tick(grown) {
    for (const plot of this.list) {
      if (!plot.seen()) continue;
      if (grown) plot.fit();
      plot.tick();
    }
  }
}
