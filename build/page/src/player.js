// The bar at the bottom: play, step, slider over the contact load, speed.
import { byId, color, reducedMotion } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg";

function icon(path) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  const shape = document.createElementNS(SVG, "path");
  shape.setAttribute("d", path);
  svg.append(shape);
  return svg;
}

const PLAY = "M4 2l10 6-10 6z";
const PAUSE = "M3 2h4v12H3zM9 2h4v12H9z";
const STEP = "M2 2l8 6-8 6zM12 2h2v12h-2z";

export class Player {
  /** @param remote what tells a live simulation; undefined for a recorded run */
  constructor(run, contacts, weight, remote) {
    Object.assign(this, { run, contacts, weight, remote, playing: false, speed: 1 });
    this.changed = () => {};
    this.slider = byId("seek");
    this.slider.disabled = Boolean(remote);
    this.slider.min = run.start;
    this.slider.max = Math.max(run.end, run.start + 1e-9);
    byId("end").textContent = remote ? "" : `/ ${run.end.toFixed(2)} s`;
    byId("step").append(icon(STEP));
    byId("play").addEventListener("click", () => this.play(!this.playing));
    byId("step").addEventListener("click", () => this.step(1));
    this.slider.addEventListener("input", () => {
      this.play(false);
      this.seek(Number(this.slider.value));
    });
    // The slider's own keys move by a hundredth of its length; rows are what counts here.
    this.slider.addEventListener("keydown", (event) => {
      if (event.key.startsWith("Arrow") || event.key === "Home" || event.key === "End") {
        event.preventDefault();
      }
    });
    byId("speed").addEventListener("change", ({ target }) => {
      this.speed = Number(target.value);
      remote?.speed(this.speed);
    });
    this.show(false);
  }

  show(playing) {
    this.playing = playing;
    const button = byId("play");
    button.replaceChildren(icon(playing ? PAUSE : PLAY));
    button.setAttribute("aria-label", playing ? "Pause" : "Play");
  }

  play(on) {
    if (this.remote) this.remote.play(on);
    else if (on && this.run.now >= this.run.end) this.seek(this.run.start);
    this.show(on);
  }

  /** Plays by itself, unless the reader wants as little motion as possible. */
  autoplay() {
    if (!reducedMotion()) this.play(true);
  }

  seek(time) {
    if (this.remote) return;
    this.run.locate(time);
    this.changed();
  }

  /** Goes on by rows; a live simulation takes a step. */
  step(rows) {
    this.play(false);
    if (this.remote) {
      this.remote.step();
      return;
    }
    const row = Math.min(Math.max(this.run.nearest() + rows, 0), this.run.rows - 1);
    this.seek(this.run.time[row]);
  }

  /** Goes on by time. */
  jump(seconds) {
    this.play(false);
    this.seek(this.run.now + seconds);
  }

  /** After `seconds` of the reader's time. */
  advance(seconds) {
    if (!this.playing || this.remote) return;
    const time = this.run.now + seconds * this.speed;
    if (time >= this.run.end) this.show(false);
    this.seek(time);
  }

  tick() {
    const { run, slider } = this;
    byId("time").textContent = run.now.toFixed(2);
    if (this.remote) {
      slider.min = run.start;
      slider.max = Math.max(run.end, run.start + 1e-9);
    }
    slider.value = run.now;
    slider.setAttribute("aria-valuetext", `${run.now.toFixed(2)} s`);
  }

  /** The load of all contacts, under the slider: where a robot lands or falls is seen at once. */
  band() {
    const canvas = byId("load");
    const width = (canvas.width = canvas.clientWidth * devicePixelRatio);
    const height = (canvas.height = canvas.clientHeight * devicePixelRatio);
    const context = canvas.getContext("2d");
    context.fillStyle = color("line");
    context.fillRect(0, height * 0.46, width, height * 0.08);
    if (this.remote || !this.contacts.list.length || this.run.end <= this.run.start) return;
    context.fillStyle = color("dim");
    context.globalAlpha = 0.5;
    const bars = Math.floor(width / 2);
    const { run } = this;
    const seconds = (run.end - run.start) / bars;
    let row = 0;
    for (let bar = 0; bar < bars; bar++) {
      let most = 0;
      const until = run.start + (bar + 1) * seconds;
      // Long runs are looked at here and there; each bar has a few rows at least.
      const first = row;
      while (row < run.rows - 1 && run.time[row] < until) row += 1;
      const stride = Math.max(1, Math.floor((row - first) / 16));
      for (let i = first; i <= row; i += stride) most = Math.max(most, this.contacts.load(run, i));
      // Three times the weight fills the band.
      const tall = Math.min(most / this.weight / 3, 1) * height * 0.9;
      context.fillRect(bar * 2, (height - tall) / 2, 1.4, tall);
    }
  }
}
