// The robot in its surroundings: what is drawn, and the toggles for it.
import { Box3, Vector3 } from "three";
import { Contacts } from "./contacts.js";
import { byId, element } from "./dom.js";
import { Arrow, Path, frame } from "./marks.js";
import { Robot } from "./robot.js";
import { Stage, reach } from "./stage.js";

/** Milliseconds for a frame above which less is drawn, and frames over which that is judged. */
const SLOW = 45;
const JUDGED = 12;

const TOGGLES = [
  ["follow", "f", "Follow", "Camera follows the robot (F)", true],
  ["forces", "c", "Forces", "Contact forces (C)", true],
  ["path", "t", "Path", "Path of the base (T)", true],
  ["frames", "x", "Frames", "Frames of the links (X)", false],
  ["shapes", "v", "Shapes", "What touches the ground in the simulation (V)", false],
];

const MOVING = new Set(["follow", "forces", "path"]);

export class View {
  /**
   * @param still whether there is nothing but the robot's start
   * @param quality what is left out, from 0 for nothing to 3; chosen by itself if undefined
   */
  constructor(scene, run, { live, still, quality }) {
    Object.assign(this, { scene, run, live, still, quality, shown: {}, buttons: {}, dirty: true });
    this.robot = new Robot(scene);
    run.locate(run.start);
    this.robot.pose(run);
    const sides = this.robot.box().getSize(new Vector3());
    // A robot of which nothing is drawn has none.
    this.size = Math.max(sides.x, sides.y, sides.z) || 1;
    this.weight = Math.max(scene.head.mass * 9.81, 1e-9);
    this.contacts = new Contacts(scene, this.robot, this.size);
    for (const [name, , , , on] of TOGGLES) this.shown[name] = on;
    this.floating = scene.head.roots[0].position.variables.length > 0;
    try {
      this.#stage();
    } catch (error) {
      this.#without(error);
    }
    this.#tools();
  }

  #stage() {
    const canvas = byId("canvas");
    const { head } = this.scene;
    this.stage = new Stage(canvas, this.robot, this.size, head.ground, this.quality);
    const { scene } = this.stage;
    this.arrows = this.contacts.list.map(() => new Arrow("#56d39b", this.size));
    this.pushed = new Arrow("#ff7b9c", this.size);
    this.path = new Path(head.roots[0].position, this.size);
    scene.add(this.path.node, this.pushed.node, ...this.arrows.map(({ node }) => node));
    // Frames where something moves; those of welded links would only hide them.
    const moved = head.joints.filter(({ motions }) => motions.length).map(({ child }) => child);
    const bases = head.roots.map(({ link }) => link);
    this.frames = [...bases, ...moved].map((link) => {
      const lines = frame(this.size * 0.12);
      this.robot.links[link].add(lines);
      return lines;
    });
    // In the midst of another page the wheel scrolls that page.
    this.stage.controls.enableZoom = window.parent === window;
    this.stage.controls.addEventListener("change", () => {
      this.dirty = true;
    });
    addEventListener("redraw", () => {
      this.dirty = true;
    });
    const tip = byId("tip");
    canvas.addEventListener("pointermove", (event) => {
      const hit = event.buttons ? undefined : this.stage.pick(event);
      tip.hidden = !hit;
      if (!hit) return;
      tip.textContent = head.links[hit.link].name;
      tip.style.left = `${event.offsetX + 14}px`;
      tip.style.top = `${event.offsetY + 10}px`;
    });
    canvas.addEventListener("pointerleave", () => {
      tip.hidden = true;
    });
    canvas.addEventListener("webglcontextlost", () => this.#without(new Error("WebGL was lost")));
  }

  /** Plots and tables need no WebGL, so they go on. */
  #without(error) {
    this.stage = undefined;
    this.reason = String(error.message ?? error);
    const overlay = byId("overlay");
    overlay.classList.add("plain");
    overlay.textContent = "This browser shows no 3-D view, because it has no WebGL. "
      + (this.still ? "The picture in index.html shows the robot."
        : "Plots, variables and parameters work without.");
    overlay.hidden = false;
  }

  #tools() {
    const bar = byId("tools");
    for (const [name, key, label, title] of TOGGLES) {
      // What moves or acts has no place in a still.
      if (this.still && MOVING.has(name)) continue;
      const button = element("button", {
        type: "button", textContent: label, title, "aria-pressed": this.shown[name],
        "data-key": key, disabled: !this.stage,
      });
      button.addEventListener("click", () => this.toggle(name));
      this.buttons[name] = button;
      bar.append(button);
    }
    const home = element("button", {
      type: "button", textContent: "Home", title: "Camera back to its place (R)", "data-key": "r",
      disabled: !this.stage,
    });
    home.addEventListener("click", () => this.home());
    bar.append(home);
  }

  toggle(name) {
    if (!this.stage || !this.buttons[name]) return;
    this.shown[name] = !this.shown[name];
    this.buttons[name].setAttribute("aria-pressed", this.shown[name]);
    const { frames, shapes } = this.shown;
    for (const lines of this.frames) lines.visible = frames;
    this.robot.showHulls(shapes);
    this.robot.fade(frames || shapes);
    this.dirty = true;
  }

  home() {
    if (!this.stage) return;
    // A robot that stands still in the world is seen whole throughout the run.
    const whole = !this.live && !this.floating;
    const now = this.run.now;
    const box = whole ? reach(this.robot, this.run) : undefined;
    this.run.locate(now);
    this.robot.pose(this.run);
    // The title stands above the robot and not on it.
    const { offsetTop, offsetHeight } = document.querySelector("header");
    this.stage.home(box ?? this.robot.box(new Box3()), offsetHeight && offsetTop + offsetHeight);
    this.stage.follow(false);
    this.dirty = true;
  }

  theme(name) {
    this.stage?.theme(name);
    this.dirty = true;
  }

  resize() {
    this.stage?.resize();
    this.dirty = true;
  }

  /** Draws the present. */
  draw() {
    this.dirty = false;
    this.robot.pose(this.run);
    if (!this.stage) return;
    this.stage.follow(this.shown.follow);
    const force = new Vector3();
    const point = new Vector3();
    this.contacts.list.forEach((contact, i) => {
      this.contacts.force(contact, this.run, force);
      const length = (force.length() / this.weight) * this.size * 1.1;
      if (!this.shown.forces || length < 1e-6) this.arrows[i].hide();
      else this.arrows[i].show(this.contacts.point(contact, this.run, point), force, length);
    });
    if (this.push) this.pushed.show(this.push.from, this.push.along, this.push.along.length());
    else this.pushed.hide();
    if (this.shown.path) this.path.update(this.run);
    else this.path.node.visible = false;
    this.stage.draw();
  }

  /** Notes how long frames take while something moves, and draws less where it is too long. */
  judge(now) {
    const took = now - (this.before ?? now);
    this.before = now;
    if (!this.stage || this.quality !== undefined || took > 1500) return;
    this.spent = (this.spent ?? 0) + took;
    this.judged = (this.judged ?? 0) + 1;
    if (this.judged < JUDGED) return;
    if (this.spent / this.judged > SLOW) this.stage.lower();
    this.spent = this.judged = 0;
  }

  /** Camera keys; true where it was one. */
  key(key) {
    const toggle = TOGGLES.find(([, letter]) => letter === key);
    if (toggle) this.toggle(toggle[0]);
    else if (key === "r") this.home();
    else if (this.stage && CAMERA[key]) {
      this.stage.turn(...CAMERA[key]);
      this.dirty = true;
    } else return false;
    return true;
  }
}

/** Turn, tilt, zoom. */
const CAMERA = {
  "[": [-0.12, 0, 1], "]": [0.12, 0, 1], pageup: [0, 0.08, 1], pagedown: [0, -0.08, 1],
  "+": [0, 0, 0.9], "=": [0, 0, 0.9], "-": [0, 0, 1.1],
};
