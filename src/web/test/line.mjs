// A line between the page and the daemon: it can be late, uneven, stalled, narrow or cut. What a
// lost packet does to TCP is a stall: nothing arrives until it was sent again, and then all at once.
import { createServer, connect } from "node:net";
import { readFileSync } from "node:fs";
import { basename, join } from "node:path";

const wait = (ms) => new Promise((done) => setTimeout(done, ms));

/** Numbers from 0 to 1, the same ones for a seed. */
export function diceOf(seed) {
  let state = seed >>> 0;
  return () => ((state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32);
}

const KINDS = { html: "text/html; charset=utf-8", js: "text/javascript; charset=utf-8", css: "text/css; charset=utf-8",
  svg: "image/svg+xml", webmanifest: "application/manifest+json" };

/** The messages that a browser sends, from the bytes of its WebSocket. */
export class Frames {
  constructor(take) { [this.take, this.rest, this.isOpen] = [take, Buffer.alloc(0), false]; }

  add(data) {
    this.rest = Buffer.concat([this.rest, data]);
    if (!this.isOpen) {
      const end = this.rest.indexOf("\r\n\r\n");
      if (end < 0) return;
      [this.rest, this.isOpen] = [this.rest.subarray(end + 4), true];
    }
    for (;;) {
      if (this.rest.length < 6) return;
      const short = this.rest[1] & 127;
      const head = short === 126 ? 8 : short === 127 ? 14 : 6;
      if (this.rest.length < head) return;
      const length = short === 126 ? this.rest.readUInt16BE(2) : short === 127 ? Number(this.rest.readBigUInt64BE(2)) : short;
      if (this.rest.length < head + length) return;
      const mask = this.rest.subarray(head - 4, head);
      const message = this.rest.subarray(head, head + length).map((byte, i) => byte ^ mask[i & 3]);
      const isBinary = (this.rest[0] & 15) === 2;
      this.rest = this.rest.subarray(head + length);
      this.take(message, isBinary);
    }
  }
}

export class Line {
  /**
   * `late()`: milliseconds that the next piece needs; pieces keep their order. `bits`: bits a second
   * toward the page. `folder`: the page itself comes from there. `delivered(message, isBinary, connection)`:
   * a message of the page has reached the daemon.
   */
  static async to(port, { late = null, bits = Infinity, folder = null, delivered = null } = {}) {
    const line = new Line();
    Object.assign(line, { pairs: new Set(), connections: 0, toPage: 0 });
    line.server = createServer({ allowHalfOpen: true }, (near) => {
      const far = connect({ port, host: "127.0.0.1", allowHalfOpen: true });
      const pair = { near, far, number: ++line.connections, isCut: false };
      near.setNoDelay(true);
      far.setNoDelay(true);
      line.pairs.add(pair);
      const frames = delivered && new Frames((message, isBinary) => delivered(message, isBinary, pair.number));
      const pass = (from, to, act) => {
        let before = Promise.resolve();
        from.on("data", (data) => {
          if (!late && bits === Infinity) { if (!pair.isCut && to.writable) act(data); return; }
          const arrives = late ? wait(late()) : null;
          before = before.then(() => arrives).then(() => !pair.isCut && to.writable && act(data));
        });
        from.on("error", () => to.destroy());
        from.on("end", () => { before = before.then(() => to.end()); });
        from.on("close", () => line.pairs.delete(pair));
      };
      pass(near, far, (data) => {
        const asked = data.toString("latin1");
        if (!asked.startsWith("GET ")) {
          far.write(data);
        } else {
          if (folder && line.serves(folder, asked.split(" ")[1], near)) return;
          // The daemon answers to its own name only.
          far.write(Buffer.from(asked.replaceAll(`127.0.0.1:${line.port}`, `127.0.0.1:${port}`), "latin1"));
        }
        frames?.add(data);
      });
      let free = 0;
      pass(far, near, (data) => {
        line.toPage += data.length;
        if (bits === Infinity) return near.write(data);
        const now = performance.now();
        free = Math.max(free, now) + (data.length * 8e3) / bits;
        far.pause();
        // A timer is some milliseconds late, so a piece goes out that much early.
        return wait(Math.max(0, free - now - 5)).then(() => { near.write(data); far.resume(); });
      });
    });
    await new Promise((done) => line.server.listen(0, "127.0.0.1", done));
    line.port = line.server.address().port;
    return line;
  }

  /** The link of the daemon by way of this line. */
  link(of) { return `http://127.0.0.1:${this.port}/${new URL(of).hash}`; }

  serves(folder, path, near) {
    const name = path === "/" ? "index.html" : basename(path);
    let bytes;
    try { bytes = readFileSync(join(folder, name)); } catch { return false; }
    const kind = KINDS[name.split(".").pop()];
    near.end(Buffer.concat([Buffer.from(`HTTP/1.1 200 OK\r\ncontent-type: ${kind}\r\ncontent-length: ${bytes.length}\r\n`
      + "content-security-policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
      + "manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\nconnection: close\r\n\r\n"), bytes]));
    return true;
  }

  /** Cuts every connection: what was on the way is lost; the daemon reads what had arrived. */
  cut() {
    for (const pair of this.pairs) {
      pair.isCut = true;
      pair.near.destroy();
      pair.far.end();
      pair.far.resume();
      this.pairs.delete(pair);
    }
  }

  close() {
    this.cut();
    this.server.close();
  }
}
