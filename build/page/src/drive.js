// Drives wheels by W A S D, arrow keys or pads.
import { Box3, Vector3 } from "three";
import { element, withKeys } from "./dom.js";

/** Milliseconds between commands. */
const PERIOD = 33;

/** Seconds from standing to top speed: a robot that is told to go or stop at once falls over. */
const RAMP = 2;

/** rad/s², for turning on the spot. */
const TURN_RAMP = 1.2;

const KEYS = {
  w: "ahead", arrowup: "ahead", s: "back", arrowdown: "back", a: "left", arrowleft: "left",
  d: "right", arrowright: "right",
};

const UP = new Vector3(0, 0, 1);

/**
 * Joints that are wheels by their geometry, whatever their names: driven by velocity, with an axis
 * that lies flat, and a link that touches the ground.
 */
export function wheels({ head }, robot, size) {
  const found = [];
  for (const joint of head.joints) {
    const command = joint.variables["cmd.velocity"];
    if (!command || joint.motions.length !== 1 || joint.motions[0].kind !== "turn") continue;
    const { node } = robot.motions.find(({ motion }) => motion === joint.motions[0]);
    const axis = new Vector3(...joint.motions[0].axis).transformDirection(node.parent.matrixWorld);
    const box = new Box3().setFromObject(node);
    const place = new Vector3().setFromMatrixPosition(node.matrixWorld);
    const radius = place.z - box.min.z;
    if (Math.abs(axis.z) > 0.3 || box.min.z > 0.03 * size || !(radius > 0)) continue;
    found.push({ command, place, radius, roll: axis.cross(UP) });
  }
  if (found.length < 2) return null;
  const sum = new Vector3();
  for (const { roll } of found) sum.add(new Vector3(Math.abs(roll.x), Math.abs(roll.y), 0));
  const ahead = sum.x >= sum.y ? new Vector3(1, 0, 0) : new Vector3(0, 1, 0);
  const left = UP.clone().cross(ahead);
  const middle = found.reduce((a, { place }) => a + place.dot(left), 0) / found.length;
  const list = found.map((wheel) => ({
    ...wheel, sign: Math.sign(wheel.roll.dot(ahead)) || 1, side: wheel.place.dot(left) - middle,
  }));
  const half = list.reduce((a, { side }) => a + Math.abs(side), 0) / list.length;
  const slowest = Math.min(...list.map(({ radius }) => radius));
  return { list, half: Math.max(half, 1e-3), slowest };
}

export class Drive {
  constructor(pane, found, live, size) {
    Object.assign(this, { found, live, held: {}, pads: {}, speed: 0, turn: 0, active: false });
    // A robot length a second, within what is safe for most.
    this.top = Math.min(Math.max(0.7 * size, 0.05), 1.5);
    const pad = (name, text, label) => {
      const button = element("button", { type: "button", textContent: text, "aria-label": label });
      const press = (on) => (event) => {
        event.preventDefault();
        this.press(name, on);
      };
      button.addEventListener("pointerdown", press(true));
      for (const end of ["pointerup", "pointerleave", "pointercancel"]) {
        button.addEventListener(end, press(false));
      }
      button.addEventListener("keydown", (event) => {
        if (event.key === "Enter" && !event.repeat) press(true)(event);
      });
      button.addEventListener("keyup", (event) => {
        if (event.key === "Enter") press(false)(event);
      });
      this.pads[name] = button;
      return button;
    };
    const label = element("span", { className: "quiet" });
    const slider = element("input", {
      type: "range", className: "wide", min: 0.02, max: Math.max(2, 2 * this.top), step: 0.01,
      value: this.top, "aria-label": "Top speed, m/s",
    });
    const show = () => {
      this.top = Number(slider.value);
      label.textContent = `${this.top.toFixed(2)} m/s`;
    };
    slider.addEventListener("input", show);
    show();
    pane.append(
      element("h2", { className: "row" }, "Drive",
        element("span", { className: "quiet" }, ...withKeys("`W` `A` `S` `D` or arrows"))),
      element("div", { className: "pads" }, element("span"), pad("ahead", "↑", "Ahead"),
        element("span"), pad("left", "←", "Left"), pad("back", "↓", "Back"),
        pad("right", "→", "Right")),
      element("div", { className: "row" }, element("span", { textContent: "Top speed" }), label),
      slider,
    );
    addEventListener("blur", () => this.stop());
    document.addEventListener("visibilitychange", () => this.stop());
    this.last = performance.now();
    setInterval(() => this.#command(), PERIOD);
  }

  press(name, on) {
    this.held[name] = on;
    this.pads[name].classList.toggle("on", on);
  }

  /** Lets all keys go. */
  stop() {
    for (const name of Object.keys(this.held)) this.press(name, false);
  }

  /** True where the key is one of ours. */
  key(key, down) {
    const name = KEYS[key];
    if (name) this.press(name, down);
    return Boolean(name);
  }

  /** After a reset nothing is left of the speed. */
  forget() {
    this.speed = this.turn = 0;
  }

  #command() {
    const { held, found, top } = this;
    // A page that is slow to draw is late to command: the time since the last one counts.
    const now = performance.now();
    const seconds = (now - this.last) / 1000;
    this.last = now;
    const asked = (plus, minus) => Number(Boolean(held[plus])) - Number(Boolean(held[minus]));
    const near = (now, wanted, most) => now + Math.min(Math.max(wanted - now, -most), most);
    const turn = (top / found.half) * 0.6;
    this.speed = near(this.speed, asked("ahead", "back") * top, (top / RAMP) * seconds);
    this.turn = near(this.turn, asked("left", "right") * turn, TURN_RAMP * seconds);
    const moving = Math.abs(this.speed) + Math.abs(this.turn) > 1e-6
      || Object.values(held).some(Boolean);
    if (moving) {
      this.live.hold(Object.fromEntries(found.list.map(({ command, sign, side, radius }) =>
        [command, (sign * (this.speed - this.turn * side)) / radius])));
    } else if (this.active) {
      this.live.release(found.list.map(({ command }) => command));
    }
    this.active = moving;
  }
}
