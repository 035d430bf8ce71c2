// The WebSocket: reconnects, keeps the server busy, measures how long answers take.

import { decode } from "./frames.js";

const RECONNECT_MS = 1000;
const AHEAD = 2; // pushes on their way: one being answered, one so that the next starts at once

export class Link {
  /** `handlers`: onScene, onSection, onAnswer, onText, onClosed. */
  constructor(handlers) {
    this.handlers = handlers;
    this.sent = new Map(); // id of a push not answered yet → when it was sent
    this.next = null; // makes the newest push, which waits for its turn
    this.arrivals = [];
    this.latencyMs = null;
    this.drawnIn = null; // a list gets the latency of every answer drawn
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

  /** Have the load answered as it is when its turn comes; `make` returns the message. */
  push(make) {
    this.next = make;
    this.turn();
  }

  /** No answer is wanted any more. */
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

  /** A push has its answer, and those before it will not get one; returns when it was sent. */
  settle(id) {
    const when = this.sent.get(id) ?? null;
    for (const old of this.sent.keys()) if (id === null || old <= id) this.sent.delete(old);
    this.turn();
    return when;
  }

  receive(data) {
    if (typeof data === "string") {
      const message = JSON.parse(data);
      if (message.kind === "error") this.settle(message.id);
      return this.handlers.onText(message);
    }
    const { header, arrays } = decode(data);
    if (header.kind === "scene") this.handlers.onScene(header, arrays);
    else if (header.kind === "section") this.handlers.onSection(header, arrays);
    else this.handlers.onAnswer(header, arrays, this.settle(header.id));
  }

  /** Note that the answer to a push sent at `when` is on the screen. */
  drawn(when) {
    const now = performance.now();
    this.latencyMs = now - when;
    this.arrivals.push(now);
    this.drawnIn?.push(this.latencyMs);
  }

  /** Answers drawn in the last second. */
  rate() {
    const since = performance.now() - 1000;
    this.arrivals = this.arrivals.filter((t) => t > since);
    return this.arrivals.length;
  }
}
