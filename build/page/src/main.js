// Puts the page together: a recorded run, or a live simulation where the page carries none.
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { columns, unpack } from "./container.js";
import { defaultPlots } from "./defaults.js";
import { byId, element, reducedMotion, short } from "./dom.js";
import { Drive, wheels } from "./drive.js";
import { Inputs } from "./inputs.js";
import { Live } from "./live.js";
import { Tabs, Variables, notes, parameters } from "./panels.js";
import { Player } from "./player.js";
import { Plots } from "./plots.js";
import { Push } from "./push.js";
import { Run } from "./run.js";
import { View } from "./view.js";

/** Share of the speed asked for, below which it is said that it is not reached. */
const SLOW = 0.9;

const query = new URLSearchParams(location.search);

/** Milliseconds between two looks at numbers. */
const NUMBERS = 90;

const KEYS = [
  ["`Space`", "play or pause"],
  ["`.`", "one step"],
  ["`←` `→`", "one row back or on"],
  ["`Shift` `←` `→`", "0.1 s back or on"],
  ["`Home` `End`", "first and last row"],
];

const LIVE_KEYS = [
  ["`Space`", "run or pause"],
  ["`.`", "one step"],
  ["`W` `A` `S` `D`", "drive"],
  ["`Ctrl` drag", "push a link"],
  ["`Backspace`", "reset"],
];

const VIEW_KEYS = [
  ["`F` `C` `T`", "follow, forces, path"],
  ["`X` `V`", "frames, collision shapes"],
  ["`R` `L`", "camera home, light or dark"],
  ["`[` `]`", "turn the camera"],
  ["`PgUp` `PgDn`", "tilt the camera"],
  ["`+` `-`", "zoom"],
  ["plots", "click: go there; drag: zoom; double click: all"],
];

function summary(head, run, live) {
  const moving = head.joints.filter(({ motions }) => motions.length);
  const count = (n, word, words) => `${n} ${n === 1 ? word : words}`;
  const parts = [
    count(head.links.length, "link", "links"),
    count(moving.length, "moving joint", "moving joints"), `${short(head.mass)} kg`,
  ];
  if (live) parts.push("live");
  else if (run.rows > 1) parts.push(`${short(run.end - run.start)} s in ${count(run.rows, "row", "rows")}`);
  return parts.join(" · ");
}

function recordedRun(recorded, stepped) {
  const all = columns(recorded);
  const time = all.get("time");
  all.delete("time");
  return new Run(time, all, time.length, stepped);
}

class Page {
  constructor(scene, recorded) {
    const { head } = scene;
    Object.assign(this, { scene, live: !recorded, dirty: true, looked: 0 });
    const outputs = head.variables.filter(({ causality }) => causality === "output");
    const stepped = new Set(outputs.filter(({ kind }) => kind !== "real").map(({ name }) => name));
    this.outputs = outputs.map(({ name }) => name);
    this.run = this.live ? Run.live(this.outputs, stepped) : recordedRun(recorded, stepped);
    this.recorded = recorded?.head ?? { notes: [], changed: {} };
    // An FMU's documentation shows the robot as it starts, and nothing beside it.
    this.still = Boolean(this.recorded.still);
    document.body.classList.toggle("still", this.still);
    this.theme = query.get("theme")
      ?? (matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
    document.documentElement.dataset.theme = this.theme;
  }

  async start() {
    const { scene, run, live } = this;
    const { head } = scene;
    byId("name").textContent = this.recorded.title || head.robot;
    byId("summary").textContent = summary(head, run, live);
    if (live) {
      this.socket = new Live(run, this.outputs);
      await this.socket.first;
    }
    const quality = query.has("quality") ? Number(query.get("quality")) : undefined;
    this.view = new View(scene, run, { live, still: this.still, quality });
    this.player = new Player(run, this.view.contacts, this.view.weight, this.socket);
    this.player.changed = () => {
      this.dirty = true;
    };
    this.#panels();
    this.#theme();
    this.#keys();
    this.#resize();
    new ResizeObserver(() => this.#resize()).observe(document.body);
    this.view.home();
    if (Number.isFinite(Number.parseFloat(query.get("t")))) {
      // The camera goes along from the start.
      this.view.draw();
      this.player.seek(Number(query.get("t")));
    }
    for (const name of (query.get("show") ?? "").split(",").filter(Boolean)) {
      if (name in this.view.shown && !this.view.shown[name]) this.view.toggle(name);
    }
    this.#look(true);
    this.view.draw();
    if (query.has("play") && !live) this.player.autoplay();
    this.before = performance.now();
    requestAnimationFrame((now) => this.#loop(now));
    requestAnimationFrame(() => {
      document.body.dataset.ready = "true";
    });
  }

  #panels() {
    const { head } = this.scene;
    const { run, live, view } = this;
    this.tabs = new Tabs();
    if (live) this.#driving(this.tabs.add("Drive"));
    const pane = this.tabs.add("Plots", () => this.plots?.resize());
    this.plots = new Plots(pane, run, {
      live, theme: this.theme, seek: (time) => this.player.seek(time),
    });
    const zoom = (text, label, action) => {
      const button = element("button", { type: "button", textContent: text, "aria-label": label });
      button.addEventListener("click", action);
      return button;
    };
    pane.append(element("div", { className: "zoom", role: "group", "aria-label": "Time shown" },
      zoom("−", "Show more time", () => this.plots.scale(2)),
      zoom("+", "Show less time", () => this.plots.scale(0.5)),
      zoom("All", "Show all of the time", () => this.plots.zoom(null))));
    const known = new Map(head.variables.map((variable) => [variable.name, variable]));
    for (const plot of defaultPlots(this.scene, (name) => run.columns.has(name))) {
      // What is zero throughout a recorded run, such as contacts of an arm on a table, says nothing.
      const silent = plot.names.every((name) => run.columns.get(name).every((x) => x === 0));
      if (live || !silent) this.plots.add(plot);
    }
    if (!this.plots.list.length) {
      pane.append(element("p", {
        className: "quiet", textContent: "Tick variables on the next tab to plot them.",
      }));
    }
    const listed = [...run.columns.keys()].map((name) =>
      known.get(name) ?? { name, unit: "", description: "not a variable of this FMU" });
    this.variables = new Variables(this.tabs.add("Variables", () => this.variables?.tick()),
      listed, run, this.plots);
    parameters(this.tabs.add("Parameters"),
      head.variables.filter(({ causality }) => causality === "parameter"),
      this.recorded.changed ?? {});
    const said = [...(this.recorded.notes ?? [])];
    if (view.reason) said.push(`There is no 3-D view: ${view.reason}`);
    notes(this.tabs.add("Notes"), {
      robot: head.notes,
      run: said,
      keys: [...(live ? LIVE_KEYS : KEYS), ...VIEW_KEYS],
    });
  }

  #driving(pane) {
    const { head } = this.scene;
    const { socket, view } = this;
    const reset = element("button", { type: "button", textContent: "Reset" });
    reset.addEventListener("click", () => this.#reset());
    pane.append(element("div", { className: "actions" }, reset));
    const found = wheels(this.scene, view.robot, view.size);
    if (found) this.drive = new Drive(pane, found, socket, view.size);
    const inputs = new Inputs(socket);
    const all = head.variables.filter(({ causality }) => causality === "input");
    const forces = new Set(head.wrenches.flatMap(({ force, torque }) => [...force, ...torque]));
    const wheelNames = new Set(found?.list.map(({ command }) => command));
    const main = new Map();
    for (const joint of head.joints) {
      for (const kind of ["position", "velocity", "effort"]) {
        const name = joint.variables[`cmd.${kind}`];
        if (name) main.set(name, joint.name);
      }
    }
    const first = all.filter(({ name }) => main.has(name) && !wheelNames.has(name));
    const later = all.filter(({ name }) => !main.has(name) || wheelNames.has(name));
    const group = (title, list, label) => {
      if (!list.length) return;
      pane.append(element("details", {}, element("summary", { textContent: title }),
        ...list.map((variable) => inputs.add(variable, label(variable)))));
    };
    if (first.length) pane.append(element("h2", { textContent: "Inputs" }));
    for (const variable of first) pane.append(inputs.add(variable, main.get(variable.name)));
    this.push = new Push(pane, view, socket);
    group("More inputs", later.filter(({ name }) => !forces.has(name)), ({ name }) => name);
    group("Forces from outside", later.filter(({ name }) => forces.has(name)), ({ name }) => name);
    inputs.follow();
    socket.listen(({ speed }) => {
      const choice = byId("speed");
      if (speed === undefined) return;
      if (![...choice.options].some(({ value }) => Number(value) === speed)) {
        choice.append(element("option", { value: speed, textContent: `${short(speed)}×` }));
      }
      choice.value = String(speed);
    });
  }

  #reset() {
    this.push?.drop();
    this.drive?.forget();
    this.socket.reset();
  }

  #theme() {
    const button = element("button", { type: "button", title: "Light or dark (L)" });
    const show = () => {
      document.documentElement.dataset.theme = this.theme;
      button.textContent = this.theme === "dark" ? "Light" : "Dark";
      this.view.theme(this.theme);
      this.dirty = true;
    };
    this.switchTheme = () => {
      this.theme = this.theme === "dark" ? "light" : "dark";
      show();
      this.plots.retheme(this.theme);
      this.player.band();
    };
    button.addEventListener("click", this.switchTheme);
    byId("tools").append(button);
    show();
  }

  #keys() {
    addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const { target } = event;
      const typing = target.matches("input:not([type=range]):not([type=checkbox]), select");
      const sliding = target.matches("#side input[type=range]");
      const pressing = event.key === " " && target.matches("button, summary, input");
      if (typing || (sliding && event.key.startsWith("Arrow")) || pressing) return;
      if (this.#key(event)) event.preventDefault();
    });
    addEventListener("keyup", ({ key }) => this.drive?.key(key.toLowerCase(), false));
  }

  #key({ key: name, shiftKey }) {
    const key = name.toLowerCase();
    const { player, run, live } = this;
    if (live && this.drive?.key(key, true)) return true;
    const actions = {
      " ": () => player.play(!player.playing),
      ".": () => player.step(1),
      l: () => this.switchTheme(),
    };
    if (live) actions.backspace = () => this.#reset();
    else {
      actions.arrowright = () => (shiftKey ? player.jump(0.1) : player.step(1));
      actions.arrowleft = () => (shiftKey ? player.jump(-0.1) : player.step(-1));
      actions.home = () => player.jump(run.start - run.now);
      actions.end = () => player.jump(run.end - run.now);
    }
    if (!actions[key]) return this.view.key(key);
    actions[key]();
    return true;
  }

  #resize() {
    this.view.resize();
    this.plots.resize();
    this.player.band();
  }

  /** What is written about the robot's state. */
  #state() {
    const { head } = this.scene;
    const { run, socket } = this;
    const parts = [];
    const part = (label, value, unitName, className = "") => {
      const node = element("span", { className }, label ? `${label} ` : "",
        element("b", { textContent: value }), unitName);
      parts.push(node);
    };
    const base = head.roots[0].position.variables;
    if (base.length) {
      const velocity = base.map((name) => name.replace(/position(.[xyz])$/, "linear_velocity$1"));
      const speed = velocity.map((name) => run.value(name));
      if (speed.every((x) => x !== undefined)) {
        part("speed", Math.hypot(...speed).toFixed(2), " m/s");
      }
      const height = run.value(base[2]);
      if (height !== undefined) part("height", (Math.round(height * 1000) / 1000 + 0).toFixed(3), " m");
      for (const angle of ["roll", "pitch"]) {
        const name = base[0].replace(/position(.)x$/, `rpy$1${angle}`);
        const value = run.value(name);
        if (value !== undefined) part(angle, (Math.round((value * 1800) / Math.PI) / 10 + 0).toFixed(1), "°");
      }
    }
    if (socket) {
      if (socket.paused) part("", "paused", "");
      else {
        const wanted = Number(byId("speed").value);
        const slow = socket.factor < SLOW * wanted;
        part("", `${socket.factor.toFixed(2)}×`, slow ? " real time: too slow for more"
          : " real time", slow ? "slow" : "");
      }
    }
    byId("state").replaceChildren(...parts);
  }

  /** Numbers and plots; not with every frame. */
  #look(grown) {
    this.player.tick();
    this.#state();
    this.plots.tick(grown);
    this.variables.tick();
  }

  #loop(now) {
    const seconds = Math.min((now - this.before) / 1000, 0.1);
    this.before = now;
    this.player.advance(seconds);
    let grown = false;
    if (this.live) {
      grown = this.socket.frames !== this.drawn;
      this.drawn = this.socket.frames;
      this.run.locate(this.run.end);
      if (this.player.playing === this.socket.paused) this.player.show(!this.socket.paused);
      this.grown ||= grown;
    }
    const moved = this.dirty || grown;
    if (moved || this.view.dirty) this.view.draw();
    else if (this.view.stage && !reducedMotion()) this.view.stage.controls.update();
    if (moved) this.due = true;
    this.dirty = false;
    if (this.player.playing) this.view.judge(now);
    if (this.due && (now - this.looked > NUMBERS || !this.player.playing)) {
      this.looked = now;
      this.due = false;
      this.#look(this.grown);
      this.grown = false;
    }
    requestAnimationFrame((next) => this.#loop(next));
  }
}

async function start() {
  const [scene, recorded] = await Promise.all([unpack("scene", 2), unpack("run", 1)]);
  const page = new Page(scene, recorded);
  await page.start();
  // For tests and the curious.
  window.page = {
    poses: () => page.view.robot.poses(),
    spans: () => page.view.robot.spans(),
    value: (name) => page.run.value(name),
    page,
  };
}

start().catch((error) => {
  document.body.dataset.error = error.stack ?? String(error);
  const overlay = byId("overlay");
  overlay.hidden = false;
  overlay.textContent = String(error.message ?? error);
});
