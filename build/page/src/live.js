// The connection to a running simulation.
import { byId } from "./dom.js";

/** Bits of a frame's first number. */
const PAUSED = 1;
const RESET = 2;

/** Milliseconds between signs of life, and between attempts to connect. */
const ALIVE = 500;
const RETRY = [250, 5000];

export class Live {
  /** @param names the outputs in the order of a frame */
  constructor(run, names) {
    Object.assign(this, { run, names, paused: true, factor: 1, listeners: [], frames: 0 });
    this.known = { inputs: {} };
    this.first = new Promise((resolve) => {
      this.arrived = resolve;
    });
    this.wait = RETRY[0];
    this.told = 0;
    this.#connect();
  }

  #connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const key = new URLSearchParams(location.search).get("k") ?? "";
    const address = `${scheme}://${location.host}/live?k=${encodeURIComponent(key)}`;
    this.socket = new WebSocket(address);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => {
      this.wait = RETRY[0];
      this.#cover("");
    };
    this.socket.onclose = () => {
      this.#cover("The simulation has ended or cannot be reached. Trying again …");
      setTimeout(() => this.#connect(), this.wait);
      this.wait = Math.min(this.wait * 2, RETRY[1]);
    };
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") this.#news(JSON.parse(data));
      else this.#frame(data);
    };
  }

  #cover(text) {
    const overlay = byId("overlay");
    if (overlay.classList.contains("plain")) return;
    overlay.textContent = text;
    overlay.hidden = !text;
  }

  #frame(data) {
    const view = new DataView(data);
    const flags = view.getUint32(0, true);
    this.factor = view.getFloat32(4, true);
    if (flags & RESET) this.run.rows = 0;
    this.run.append(this.names, view.getFloat64(8, true), new Float32Array(data, 16));
    this.paused = Boolean(flags & PAUSED);
    this.frames += 1;
    this.arrived();
    // Timers of hidden pages sleep, messages do not.
    if (performance.now() - this.told > ALIVE) this.send({ alive: true });
  }

  #news(news) {
    if ("failed" in news) this.#cover(news.failed ? `${news.failed} Reset begins anew.` : "");
    const inputs = { ...this.known.inputs, ...news.inputs };
    Object.assign(this.known, news, { inputs });
    for (const listener of this.listeners) listener(news);
  }

  /** Tells a listener what is known, and later what is new. */
  listen(listener) {
    this.listeners.push(listener);
    listener(this.known);
  }

  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return;
    this.told = performance.now();
    this.socket.send(JSON.stringify(message));
  }

  /** Sets inputs for good. */
  set(values) {
    this.send({ set: values });
  }

  /** Sets inputs for as long as something is held; the simulation lets go when we vanish. */
  hold(values) {
    this.send({ hold: values });
  }

  release(names) {
    this.send({ release: names });
  }

  play(on) {
    this.send(on ? { run: true } : { pause: true });
  }

  step() {
    this.send({ step: true });
  }

  reset() {
    this.send({ reset: true });
  }

  speed(factor) {
    this.send({ speed: factor });
  }
}
