// The connection to the daemon: it says who joins, comes back after a cut, and sends what the
// page's pen does.

import { ALIVE, type Ask, PEN_BATCH, type PageMessage, RECEIVED, readPage, type Tell } from "./protocol";

/** Milliseconds between two signs of life. */
const ALIVE_MS = 2000;
/** Messages after which it is said that they have arrived. */
const AT_ONCE = 16;
/** First and longest wait before the next try, ms. */
const FIRST_WAIT = 200;
const LONGEST_WAIT = 2000;

export interface Events {
  tell(message: Tell): void;
  page(message: PageMessage): void;
  /** The connection is there, or is being made again. */
  connected(yes: boolean): void;
}

/** Time on the page's clock, µs. */
export function pageTime(ms: number = performance.now()): number {
  return Math.max(0, Math.round(ms * 1000));
}

export class Connection {
  private socket: WebSocket | null = null;
  private wait = FIRST_WAIT;
  private batch = 0;
  private received = 0;
  private acknowledged = 0;
  private ticket: string | null = null;
  private ended = false;
  /** Times at which batches were sent, for the round trip. */
  private sent = new Map<number, number>();
  private cutAt = 0;
  /** Longest time from a cut until the page was back, ms. */
  longestAway = 0;
  /** Milliseconds from a batch to its confirmation, smoothed. */
  roundTrip = 0;

  constructor(
    private readonly key: string,
    private readonly name: string,
    private readonly events: Events,
  ) {
    this.open();
    setInterval(() => this.binary(new Uint8Array([ALIVE])), ALIVE_MS);
    addEventListener("online", () => this.open());
  }

  get isOpen(): boolean {
    return this.socket?.readyState === WebSocket.OPEN;
  }

  /** Number of the batch that was sent last. */
  get lastBatch(): number {
    return this.batch;
  }

  private open(): void {
    const state = this.socket?.readyState;
    if (this.ended || state === WebSocket.OPEN || state === WebSocket.CONNECTING) return;
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const socket = new WebSocket(`${scheme}://${location.host}/join`);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      const { key, name, ticket, received } = this;
      socket.send(JSON.stringify({ key, name, ticket, received }));
    };
    socket.onmessage = (event) => this.take(event.data as string | ArrayBuffer);
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.socket = null;
      if (this.cutAt === 0) this.cutAt = performance.now();
      this.events.connected(false);
      if (this.ended) return;
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(this.wait * 2, LONGEST_WAIT);
    };
  }

  private take(data: string | ArrayBuffer): void {
    if (data instanceof ArrayBuffer) {
      const page = readPage(data);
      this.events.page(page);
      this.received = page.message;
      // Without waiting for a frame: a card that draws slowly does not slow the line.
      if (this.received - this.acknowledged >= AT_ONCE) this.acknowledge();
      return;
    }
    const message = JSON.parse(data) as Tell;
    if (message.is === "welcome") {
      this.ticket = message.ticket;
      this.wait = FIRST_WAIT;
      this.batch = 0;
      this.sent.clear();
      if (this.cutAt > 0) {
        this.longestAway = Math.max(this.longestAway, performance.now() - this.cutAt);
        this.cutAt = 0;
      }
      if (!message.resumed) this.received = this.acknowledged = 0;
      this.events.connected(true);
    } else if (message.is === "refused") {
      this.ended = true;
    } else if (message.is === "taken") {
      this.measure(message.batch);
    }
    this.events.tell(message);
  }

  private measure(batch: number): void {
    const at = this.sent.get(batch);
    if (at !== undefined) {
      const now = performance.now() - at;
      this.roundTrip = this.roundTrip === 0 ? now : this.roundTrip * 0.9 + now * 0.1;
    }
    for (const number of this.sent.keys()) if (number <= batch) this.sent.delete(number);
  }

  /** Tells the daemon what has arrived, so that it sends more. */
  acknowledge(): void {
    if (this.received === this.acknowledged || !this.isOpen) return;
    this.acknowledged = this.received;
    this.numbered(RECEIVED, this.received, new Uint8Array());
  }

  /** Sends records of the pen. Returns false if the connection is cut: they are dropped. */
  pen(records: Uint8Array): boolean {
    if (!this.isOpen) return false;
    this.batch += 1;
    this.sent.set(this.batch, performance.now());
    this.numbered(PEN_BATCH, this.batch, records);
    return true;
  }

  ask(what: Ask): void {
    if (this.isOpen) this.socket?.send(JSON.stringify(what));
  }

  /** Everything must be sent again: the picture was lost. */
  forget(): void {
    this.ticket = null;
    this.received = this.acknowledged = 0;
    this.socket?.close();
  }

  private numbered(kind: number, number: number, rest: Uint8Array): void {
    const bytes = new Uint8Array(5 + rest.length);
    bytes[0] = kind;
    new DataView(bytes.buffer).setUint32(1, number, true);
    bytes.set(rest, 5);
    this.binary(bytes);
  }

  private binary(bytes: Uint8Array<ArrayBuffer>): void {
    if (this.isOpen) this.socket?.send(bytes);
  }
}
