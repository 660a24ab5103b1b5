// Pushes a link: by Ctrl and drag, or by buttons.
import { Plane, Vector3 } from "three";
import { byId, element, withKeys } from "./dom.js";

/** Milliseconds between forces. */
const PERIOD = 16;

/** Greatest force, and force of a spring that is as long as the robot, in weights of the robot. */
const CAP = 1.5;

/** Delay of the loop through browser and simulation, s: bounds stiffness and damping. */
const DELAY = 0.035;

const DIRECTIONS = [
  ["+x", [1, 0, 0]], ["−x", [-1, 0, 0]], ["+y", [0, 1, 0]], ["−y", [0, -1, 0]],
  ["up", [0, 0, 1]], ["down", [0, 0, -1]],
];

export class Push {
  constructor(pane, view, live) {
    Object.assign(this, { view, live, grab: null });
    const { head } = view.scene;
    this.by = new Map(head.wrenches.map((wrench) => [wrench.link, wrench]));
    // A welded link is pushed by way of the one that it is welded to.
    for (const { child, parent, motions } of head.joints) {
      if (!this.by.has(child) && !motions.length && this.by.has(parent)) {
        this.by.set(child, this.by.get(parent));
      }
    }
    pane.append(element("h2", { className: "row" }, "Push",
      element("span", { className: "quiet" }, ...withKeys("`Ctrl` and drag a link"))));
    if (!head.wrenches.length) {
      pane.append(element("p", {
        className: "quiet",
        textContent: "This FMU has no inputs for forces from outside. View the URDF instead, or "
          + 'export it with [[external_wrench]] link = "*" in the settings.',
      }));
      return;
    }
    this.#buttons(pane, head);
    this.#pointer();
    addEventListener("blur", () => this.drop());
    setInterval(() => this.#pull(), PERIOD);
  }

  #buttons(pane, head) {
    const links = element("select", { className: "wide", "aria-label": "Link to push" },
      ...head.wrenches.map(({ link }) =>
        element("option", { value: link, textContent: head.links[link].name })));
    const strength = element("input", {
      type: "range", className: "wide", min: 0.02, max: CAP, step: 0.01, value: 0.3,
      "aria-label": "Strength of the push, in weights of the robot",
    });
    const label = element("span", { className: "quiet" });
    const show = () => {
      label.textContent = `${(Number(strength.value) * this.view.weight).toPrecision(3)} N`;
    };
    strength.addEventListener("input", show);
    show();
    const buttons = DIRECTIONS.map(([text, direction]) => {
      const button = element("button", {
        type: "button", textContent: text, "aria-label": `Push ${text}`,
      });
      const begin = (event) => {
        event.preventDefault();
        button.classList.add("on");
        const link = Number(links.value);
        const local = new Vector3(...head.links[link].center_of_mass);
        const force = new Vector3(...direction)
          .multiplyScalar(Number(strength.value) * this.view.weight);
        this.grab = { link, local, force };
      };
      const end = () => {
        button.classList.remove("on");
        this.drop();
      };
      button.addEventListener("pointerdown", begin);
      for (const name of ["pointerup", "pointerleave", "pointercancel", "blur"]) {
        button.addEventListener(name, end);
      }
      button.addEventListener("keydown", (event) => {
        if (event.key === "Enter" && !event.repeat) begin(event);
      });
      button.addEventListener("keyup", (event) => event.key === "Enter" && end());
      return button;
    });
    pane.append(links, element("div", { className: "pads push" }, ...buttons),
      element("div", { className: "row" }, element("span", { textContent: "Strength" }), label),
      strength);
  }

  #pointer() {
    const canvas = byId("canvas");
    const { view } = this;
    canvas.addEventListener("pointerdown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || !view.stage) return;
      const hit = view.stage.pick(event);
      if (!hit || !this.by.has(hit.link)) return;
      event.stopImmediatePropagation();
      view.stage.controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
      const local = view.robot.links[hit.link].worldToLocal(hit.point.clone());
      this.grab = { link: hit.link, local, target: hit.point.clone() };
    }, true);
    const plane = new Plane();
    canvas.addEventListener("pointermove", (event) => {
      if (!this.grab?.target || !view.stage) return;
      view.stage.camera.getWorldDirection(plane.normal);
      plane.setFromNormalAndCoplanarPoint(plane.normal.negate(), this.#point());
      view.stage.meet(event, plane, this.grab.target);
    });
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
      canvas.addEventListener(end, () => this.drop());
    }
  }

  /** The grabbed point in the world. */
  #point() {
    const { link, local } = this.grab;
    return this.view.robot.links[link].localToWorld(local.clone());
  }

  /** A spring to the pointer, damped by the velocity of the grabbed point. */
  #spring(from) {
    const { view, grab } = this;
    const { head } = view.scene;
    const { mass } = head;
    // A light link moves with a part of the robot.
    const moved = head.links[grab.link].mass + 0.1 * mass;
    const stiffness = Math.min((CAP * view.weight) / view.size, (0.3 * moved) / DELAY ** 2);
    const damping = Math.min(1.4 * Math.sqrt(stiffness * mass), (0.4 * moved) / DELAY);
    const time = view.run.end;
    if (grab.before && time > grab.before.time) {
      const velocity = from.clone().sub(grab.before.from).divideScalar(time - grab.before.time);
      grab.velocity = velocity;
    }
    if (!grab.before || time !== grab.before.time) grab.before = { from: from.clone(), time };
    const force = grab.target.clone().sub(from).multiplyScalar(stiffness);
    if (grab.velocity) force.addScaledVector(grab.velocity, -damping);
    return force.clampLength(0, CAP * view.weight);
  }

  #pull() {
    const { view, grab } = this;
    if (!grab) return;
    const from = this.#point();
    const force = grab.force ?? this.#spring(from);
    const wrench = this.by.get(grab.link);
    const center = new Vector3(...view.scene.head.links[wrench.link].center_of_mass);
    view.robot.links[wrench.link].localToWorld(center);
    const torque = from.clone().sub(center).cross(force);
    view.push = {
      from,
      along: grab.target ? grab.target.clone().sub(from)
        : force.clone().multiplyScalar(view.size / view.weight),
    };
    const values = {};
    wrench.force.forEach((name, i) => {
      values[name] = force.getComponent(i);
    });
    wrench.torque.forEach((name, i) => {
      values[name] = torque.getComponent(i);
    });
    this.live.hold(values);
  }

  drop() {
    if (!this.grab) return;
    const wrench = this.by.get(this.grab.link);
    this.grab = null;
    this.view.push = null;
    if (this.view.stage) this.view.stage.controls.enabled = true;
    this.live.release([...wrench.force, ...wrench.torque]);
  }
}
