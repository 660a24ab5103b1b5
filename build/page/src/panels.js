// The tabs beside the view: plots, variables, parameters, notes.
import { byId, element, exact, short, unit, withKeys } from "./dom.js";

/** Tabs; arrow keys go from one to the next. */
export class Tabs {
  constructor() {
    this.list = [];
    byId("tabs").addEventListener("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!step) return;
      event.stopPropagation();
      event.preventDefault();
      const at = this.list.findIndex((tab) => tab.button === document.activeElement);
      const next = this.list[(at + step + this.list.length) % this.list.length];
      this.show(next);
      next.button.focus();
    });
  }

  /** A new tab; gives its pane. */
  add(title, shown = () => {}) {
    const id = `pane-${this.list.length}`;
    const button = element("button", {
      type: "button", role: "tab", id: `tab-${this.list.length}`, textContent: title,
      "aria-controls": id,
    });
    const pane = element("div", {
      className: "pane", role: "tabpanel", id, tabIndex: 0, hidden: true,
      "aria-labelledby": button.id,
    });
    const tab = { title, button, pane, shown };
    button.addEventListener("click", () => this.show(tab));
    this.list.push(tab);
    byId("tabs").append(button);
    byId("panes").append(pane);
    if (this.list.length === 1) this.show(tab);
    return pane;
  }

  show(tab) {
    for (const { button, pane } of this.list) {
      const chosen = button === tab.button;
      button.setAttribute("aria-selected", chosen);
      button.tabIndex = chosen ? 0 : -1;
      pane.hidden = !chosen;
    }
    tab.shown();
  }
}

/** All variables with their present values; a tick plots one. */
export class Variables {
  constructor(pane, list, run, plots) {
    this.run = run;
    this.pane = pane;
    const search = element("input", {
      type: "search", placeholder: `Search ${list.length} variables`,
      "aria-label": "Search variables",
    });
    const body = element("tbody");
    this.rows = list.map(({ name, unit: unitName, description }) => {
      const value = element("td", { className: "number" });
      const box = element("input", { type: "checkbox", "aria-label": `Plot ${name}` });
      box.addEventListener("change", () => {
        if (box.checked) plots.add({ title: name, unit: unitName, names: [name] });
        else plots.remove(name);
      });
      const row = element("tr", { title: description },
        element("td", {}, element("label", {}, box, name)), value,
        element("td", { className: "unit", textContent: unit(unitName) }));
      body.append(row);
      return { name, value, row };
    });
    search.addEventListener("input", () => {
      const words = search.value.toLowerCase().split(/\s+/);
      for (const { name, row } of this.rows) {
        row.hidden = !words.every((word) => name.toLowerCase().includes(word));
      }
    });
    pane.append(search, table(["variable", "now", "unit"], body));
  }

  tick() {
    if (this.pane.hidden) return;
    for (const { name, value, row } of this.rows) {
      if (!row.hidden) value.textContent = short(this.run.value(name));
    }
  }
}

function table(names, body) {
  const heads = names.map((name, i) =>
    element("th", { textContent: name, scope: "col", className: i === 1 ? "number" : "" }));
  return element("table", {}, element("thead", {}, element("tr", {}, ...heads)), body);
}

/** Parameters; those that the run had other values of stand first and are marked. */
export function parameters(pane, list, changed) {
  const rows = list.map(({ name, unit: unitName, description, start }) => {
    const own = Object.hasOwn(changed, name);
    const value = element("td", { className: "number", textContent: exact(own ? changed[name] : start) });
    if (own) value.append(element("small", { textContent: ` instead of ${exact(start)}` }));
    const row = element("tr", { title: description, className: own ? "changed" : "" },
      element("td", { textContent: name }), value,
      element("td", { className: "unit", textContent: unit(unitName) }));
    return { own, row };
  });
  rows.sort((a, b) => b.own - a.own);
  if (!rows.length) {
    pane.append(element("p", { textContent: "This FMU has no parameters." }));
    return;
  }
  const search = element("input", {
    type: "search", placeholder: `Search ${list.length} parameters`,
    "aria-label": "Search parameters",
  });
  search.addEventListener("input", () => {
    const words = search.value.toLowerCase().split(/\s+/);
    for (const { row } of rows) {
      row.hidden = !words.every((word) => row.textContent.toLowerCase().includes(word));
    }
  });
  pane.append(search, table(["parameter", "value", "unit"],
    element("tbody", {}, ...rows.map(({ row }) => row))));
}

/** Findings about the robot and the run, and the keys. */
export function notes(pane, { robot, run, keys }) {
  for (const text of run) pane.append(element("p", { className: "said", textContent: text }));
  for (const { severity, code, message, help, place } of robot) {
    pane.append(element("section", { className: `note ${severity}` },
      element("b", { textContent: `${severity} ${code}` }),
      element("span", { className: "place", textContent: place }),
      element("p", { textContent: message }),
      ...(help ? [element("p", { className: "help", textContent: help })] : [])));
  }
  if (!robot.length && !run.length) {
    pane.append(element("p", { textContent: "Nothing looks wrong." }));
  }
  pane.append(element("h2", { textContent: "Keys" }), element("dl", { className: "keys" },
    ...keys.flatMap(([key, what]) => [
      element("dt", {}, ...withKeys(key)), element("dd", { textContent: what })])));
}
