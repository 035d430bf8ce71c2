// The WebSocket: reconnects, keeps the server busy, measures how long predictions take.

import { decode } from "./frames.js";

const RECONNECT_MS = 1000;
const PIECE = 1 << 15; // bytes of a file in one message; the server refuses longer ones
const AHEAD = 2; // patch loads on their way: one is predicted, one lets the next start at once

export class Link {
  /** `handlers`: onScene, onSection, onPrediction, onCraniotomy, onState, onText, onClosed. */
  constructor(handlers) {
    this.handlers = handlers;
    this.sent = new Map(); // id of a patch load without its prediction yet → when it was sent
    this.next = null; // makes the newest patch load, which waits for its turn
    this.arrivals = [];
    this.latencyMs = null;
    this.drawnIn = null; // a list gets the latency of every prediction drawn
    this.id = 0;
    this.connect();
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}/live`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = ({ data }) => this.receive(data);
    this.socket.onclose = () => {
      this.forget();
      this.handlers.onClosed();
      setTimeout(() => this.connect(), RECONNECT_MS);
    };
  }

  get open() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  send(message) {
    if (this.open) this.socket.send(JSON.stringify(message));
  }

  /** Announce a measured file and send it in pieces. */
  async sendFile(file, role) {
    this.send({ type: "measured_file", name: file.name, role, n_bytes: file.size });
    const content = await file.arrayBuffer();
    for (let start = 0; start < content.byteLength && this.open; start += PIECE) {
      this.socket.send(content.slice(start, start + PIECE));
    }
  }

  /** Ask for the load as it is when its turn comes; `make` returns the message. */
  request(make) {
    this.next = make;
    this.turn();
  }

  /** No prediction is wanted any more. */
  forget() {
    this.next = null;
    this.sent.clear();
  }

  turn() {
    if (this.next === null || !this.open || this.sent.size >= AHEAD) return;
    const message = { ...this.next(), id: ++this.id };
    this.next = null;
    this.sent.set(this.id, performance.now());
    this.send(message);
  }

  /** A patch load has its prediction, and those before it will not get one; returns when it was sent. */
  resolve(id) {
    const when = this.sent.get(id) ?? null;
    for (const old of this.sent.keys()) if (id === null || old <= id) this.sent.delete(old);
    this.turn();
    return when;
  }

  receive(data) {
    if (typeof data === "string") {
      const message = JSON.parse(data);
      if (message.kind === "error") this.resolve(message.id);
      return this.handlers.onText(message);
    }
    const { header, arrays } = decode(data);
    if (header.kind === "scene") this.handlers.onScene(header, arrays);
    else if (header.kind === "section") this.handlers.onSection(header, arrays);
    else if (header.kind === "craniotomy") this.handlers.onCraniotomy(header, arrays);
    else if (header.kind === "state") this.handlers.onState(header, arrays);
    else this.handlers.onPrediction(header, arrays, this.resolve(header.id));
  }

  /** Note that the prediction for a patch load sent at `when` is on the screen. */
  drawn(when) {
    const now = performance.now();
    this.latencyMs = now - when;
    this.arrivals.push(now);
    this.drawnIn?.push(this.latencyMs);
  }

  /** Predictions drawn in the last second. */
  rate() {
    const since = performance.now() - 1000;
    this.arrivals = this.arrivals.filter((t) => t > since);
    return this.arrivals.length;
  }
}
