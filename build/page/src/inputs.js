// A slider and a number for each input of a live simulation.
import { element, exact, unit } from "./dom.js";

/** Ends of a slider where the variable has none, or none that a hand can use. */
const ENDS = { rad: Math.PI, m: 1, "rad/s": 10, "m/s": 1, "N.m": 10, N: 10 };
const FAR = 30;

function ends({ min, max, unit: name, start = 0 }) {
  const usual = ENDS[name] ?? 1;
  const low = Number.isFinite(min) ? Math.max(min, -FAR) : -usual;
  const high = Number.isFinite(max) ? Math.min(max, FAR) : usual;
  return [Math.min(low, start), Math.max(high, start)];
}

export class Inputs {
  constructor(live) {
    this.live = live;
    this.rows = new Map();
  }

  /** Follows what others do; call it when all controls are there. */
  follow() {
    this.live.listen(({ inputs, held }) => {
      for (const [name, value] of Object.entries(inputs ?? {})) this.show(name, value);
      if (!held) return;
      for (const [name, { node }] of this.rows) {
        node.classList.toggle("held", held.includes(name));
      }
    });
  }

  /** The controls of a variable, below `label`. */
  add(variable, label) {
    const { name, start = 0, min, max } = variable;
    const [low, high] = ends(variable);
    const slider = element("input", {
      type: "range", min: low, max: high, step: "any", value: start, "aria-label": name,
    });
    const number = element("input", {
      type: "number", step: "any", value: exact(start), "aria-label": `${name}, exact`,
    });
    if (Number.isFinite(min)) number.min = min;
    if (Number.isFinite(max)) number.max = max;
    const node = element("div", { className: "input", title: variable.description },
      element("div", { className: "row" }, element("span", { textContent: label }),
        element("span", {}, number, ` ${unit(variable.unit)}`)), slider);
    const row = { node, slider, number, active: false };
    this.rows.set(name, row);
    const send = (value) => {
      if (!Number.isFinite(value)) return;
      this.show(name, value, true);
      this.live.set({ [name]: value });
    };
    slider.addEventListener("input", () => send(Number(slider.value)));
    slider.addEventListener("dblclick", () => send(start));
    number.addEventListener("change", () => {
      if (number.value !== "" && number.checkValidity()) send(Number(number.value));
    });
    return node;
  }

  /** Shows a value; what is being written by hand stays. */
  show(name, value, own = false) {
    const row = this.rows.get(name);
    if (!row) return;
    if (document.activeElement !== row.number || own) row.number.value = Number(value.toPrecision(6));
    if (document.activeElement !== row.slider || !own) row.slider.value = value;
  }
}
