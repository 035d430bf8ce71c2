// The WebSocket: reconnects, counts answers, measures how long they take.

import { decode } from "./frames.js";

const RECONNECT_MS = 1000;

export class Link {
  /** `handlers`: onScene, onSection, onAnswer, onText, onClosed. */
  constructor(handlers) {
    this.handlers = handlers;
    this.sent = new Map(); // push id → when it was sent
    this.arrivals = [];
    this.latencyMs = null;
    this.id = 0;
    this.connect();
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.socket = new WebSocket(`${scheme}://${location.host}/live`);
    this.socket.binaryType = "arraybuffer";
    this.socket.onmessage = ({ data }) => this.receive(data);
    this.socket.onclose = () => {
      this.handlers.onClosed();
      setTimeout(() => this.connect(), RECONNECT_MS);
    };
  }

  get open() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  /** Send a message; a push gets an id, which is returned. */
  send(message) {
    if (!this.open) return null;
    if (message.type === "push") {
      message = { ...message, id: ++this.id };
      this.sent.set(this.id, performance.now());
    }
    this.socket.send(JSON.stringify(message));
    return message.id ?? null;
  }

  receive(data) {
    if (typeof data === "string") return this.handlers.onText(JSON.parse(data));
    const { header, arrays } = decode(data);
    if (header.kind === "scene") this.handlers.onScene(header, arrays);
    else if (header.kind === "section") this.handlers.onSection(header, arrays);
    else this.handlers.onAnswer(header, arrays);
  }

  /** Note that the first answer to a push is on the screen. */
  drawn(id) {
    const sent = this.sent.get(id);
    if (sent === undefined) return;
    const now = performance.now();
    this.latencyMs = now - sent;
    for (const old of this.sent.keys()) if (old <= id) this.sent.delete(old);
    this.arrivals.push(now);
  }

  /** Answers drawn in the last second. */
  rate() {
    const since = performance.now() - 1000;
    this.arrivals = this.arrivals.filter((t) => t > since);
    return this.arrivals.length;
  }
}
