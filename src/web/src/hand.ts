// The hand on the canvas: whether it sculpts or moves the view.

import { slid, turned, zoomed } from "./camera";
import { coalesced, records } from "./pen";
import type { Camera } from "./protocol";

/** After a pen was near, touches are the palm that rests. */
const PALM_MS = 600;
/** A finger that touches may be the first of two: its stroke waits so long, or so far (px). */
const WAIT_MS = 90;
const WAIT_PX = 7;

export interface HandEvents {
  camera(): Camera;
  look(camera: Camera): void;
  extent(): number;
  /** Whether there is clay at this point of the canvas, in CSS pixels. */
  isClayAt(x: number, y: number): boolean;
  pen(records: Uint8Array): boolean;
  canSculpt(): boolean;
  fingerSculpts(): boolean;
  penSeen(): void;
  /** The pen is here, over the clay or drawing on it; null: nowhere. */
  pointerAt(event: PointerEvent | null, draws: boolean): void;
  undo(): void;
  redo(): void;
}

type Action = "sculpt" | "turn" | "slide" | "ignore";

export class Hand {
  private readonly actions = new Map<number, Action>();
  private readonly touches = new Map<number, { x: number; y: number }>();
  private penSeen = -Infinity;
  /** The beginning of a finger's stroke. */
  private waiting: PointerEvent[] = [];
  private tapped = 0;
  private moved = false;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly events: HandEvents,
  ) {
    const listen = <K extends keyof HTMLElementEventMap>(
      name: K,
      act: (event: HTMLElementEventMap[K]) => void,
    ): void => canvas.addEventListener(name, act, { passive: false });
    listen("pointerdown", (e) => this.down(e));
    listen("pointermove", (e) => this.move(e));
    listen("pointerup", (e) => this.up(e));
    listen("pointercancel", (e) => this.up(e));
    listen("pointerleave", (e) => this.leave(e));
    listen("contextmenu", (e) => e.preventDefault());
    listen("wheel", (e) => {
      e.preventDefault();
      const factor = Math.exp(-e.deltaY * (e.deltaMode === 1 ? 0.05 : 0.0015));
      events.look(zoomed(events.camera(), factor, events.extent()));
    });
    // The page shall not scroll or zoom under a hand that sculpts.
    listen("touchstart", (e) => e.preventDefault());
  }

  private send(events: PointerEvent[], inRange: boolean): boolean {
    return this.events.pen(records(events, this.canvas.getBoundingClientRect(), inRange));
  }

  private look(event: PointerEvent): void {
    if (event.pointerType !== "pen") return;
    this.penSeen = event.timeStamp;
    this.events.penSeen();
  }

  private isPalm(event: PointerEvent): boolean {
    return event.pointerType === "touch" && event.timeStamp - this.penSeen < PALM_MS;
  }

  /** Ends every stroke until the pointer comes down again: a finger turned out to be one of two,
   * or the connection was cut. */
  lift(): void {
    this.waiting = [];
    for (const [id, action] of this.actions) if (action === "sculpt") this.actions.set(id, "ignore");
  }

  private down(event: PointerEvent): void {
    event.preventDefault();
    this.canvas.setPointerCapture(event.pointerId);
    this.look(event);
    if (this.isPalm(event)) {
      this.actions.set(event.pointerId, "ignore");
      return;
    }
    if (event.pointerType === "touch") {
      if (this.touches.size === 0) [this.tapped, this.moved] = [0, false];
      this.touches.set(event.pointerId, { x: event.clientX, y: event.clientY });
      this.tapped = Math.max(this.tapped, this.touches.size);
      if (this.touches.size > 1) {
        if (this.waiting.length > 0) this.lift();
        for (const [id, action] of this.actions) {
          if (action === "sculpt" && this.touches.has(id)) this.send([withoutButtons(event)], false);
        }
        this.lift();
        this.actions.set(event.pointerId, "ignore");
        return;
      }
    }
    const action = this.actionOf(event);
    this.actions.set(event.pointerId, action);
    if (action === "sculpt" && event.pointerType === "touch") {
      this.waiting = [event];
      return;
    }
    if (action !== "sculpt") return;
    if (this.send([event], true)) this.events.pointerAt(event, true);
    else this.actions.set(event.pointerId, "ignore");
  }

  private actionOf(event: PointerEvent): Action {
    if (event.pointerType === "mouse" && event.button === 2) return event.shiftKey ? "slide" : "turn";
    if (event.pointerType === "mouse" && event.button === 1) return "slide";
    if (!this.events.canSculpt()) return "turn";
    if (event.pointerType === "touch" && !this.events.fingerSculpts()) return "turn";
    const box = this.canvas.getBoundingClientRect();
    const clay = this.events.isClayAt(event.clientX - box.left, event.clientY - box.top);
    return clay ? "sculpt" : "turn";
  }

  private move(event: PointerEvent): void {
    this.look(event);
    const action = this.actions.get(event.pointerId);
    const isGesture = this.touches.size > 1 && this.touches.has(event.pointerId);
    if (isGesture) this.gesture(event);
    else this.follow(event, action);
    // After what is sent: an expected dab goes with its batch.
    const draws = this.actions.get(event.pointerId) === "sculpt" && this.waiting.length === 0 && !isGesture;
    this.events.pointerAt(event.pointerType === "touch" && !draws ? null : event, draws);
  }

  private follow(event: PointerEvent, action: Action | undefined): void {
    const touch = this.touches.get(event.pointerId);
    const before = touch ?? { x: event.clientX - event.movementX, y: event.clientY - event.movementY };
    const [dx, dy] = [event.clientX - before.x, event.clientY - before.y];
    if (touch) {
      if (Math.hypot(dx, dy) > 4) this.moved = true;
      this.touches.set(event.pointerId, { x: event.clientX, y: event.clientY });
    }
    const height = this.canvas.clientHeight || 1;
    switch (action) {
      case "sculpt":
        if (!this.draw(coalesced(event))) this.actions.set(event.pointerId, "ignore");
        break;
      case "turn":
        this.events.look(turned(this.events.camera(), dx / height, dy / height));
        break;
      case "slide":
        this.events.look(slid(this.events.camera(), dx / height, dy / height));
        break;
      case "ignore":
        break;
      case undefined:
        // Over the clay: the others see where the pen is.
        if (this.events.canSculpt() && event.pointerType !== "touch") this.send([event], true);
    }
  }

  /** Sends a part of a stroke, or keeps it while a second finger may follow. */
  private draw(events: PointerEvent[]): boolean {
    const [first] = this.waiting;
    if (!first) return this.send(events, true);
    this.waiting.push(...events);
    const last = this.waiting[this.waiting.length - 1] ?? first;
    const far = Math.hypot(last.clientX - first.clientX, last.clientY - first.clientY) > WAIT_PX;
    if (!far && last.timeStamp - first.timeStamp < WAIT_MS) return true;
    return this.send(this.waiting.splice(0), true);
  }

  /** Two fingers turn and zoom, three slide. */
  private gesture(event: PointerEvent): void {
    const before = [...this.touches.values()];
    const moved = { x: event.clientX, y: event.clientY };
    const old = this.touches.get(event.pointerId) ?? moved;
    if (Math.hypot(moved.x - old.x, moved.y - old.y) > 4) this.moved = true;
    this.touches.set(event.pointerId, moved);
    const after = [...this.touches.values()];
    const height = this.canvas.clientHeight || 1;
    const [from, to] = [middle(before), middle(after)];
    const [dx, dy] = [(to.x - from.x) / height, (to.y - from.y) / height];
    let camera = this.events.camera();
    camera = after.length > 2 ? slid(camera, dx, dy) : turned(camera, dx, dy);
    const [a, b] = [spread(before, from), spread(after, to)];
    if (a > 8 && b > 8) camera = zoomed(camera, b / a, this.events.extent());
    this.events.look(camera);
  }

  private up(event: PointerEvent): void {
    const action = this.actions.get(event.pointerId);
    this.actions.delete(event.pointerId);
    if (action === "sculpt") {
      if (this.waiting.length > 0) this.send(this.waiting.splice(0), true);
      this.send([event], event.pointerType !== "touch");
    }
    this.events.pointerAt(event.pointerType === "touch" ? null : event, false);
    if (this.touches.delete(event.pointerId) && this.touches.size === 0 && !this.moved) {
      if (this.tapped === 2) this.events.undo();
      if (this.tapped === 3) this.events.redo();
    }
  }

  private leave(event: PointerEvent): void {
    this.events.pointerAt(null, false);
    if (!this.actions.has(event.pointerId) && this.events.canSculpt()) this.send([event], false);
  }
}

/** The same place, and nothing pressed. */
function withoutButtons(event: PointerEvent): PointerEvent {
  const { clientX, clientY, pointerType, pointerId } = event;
  return new PointerEvent("pointerup", { clientX, clientY, pointerType, pointerId });
}

function middle(points: { x: number; y: number }[]): { x: number; y: number } {
  const sum = points.reduce((a, p) => ({ x: a.x + p.x, y: a.y + p.y }), { x: 0, y: 0 });
  return { x: sum.x / points.length, y: sum.y / points.length };
}

function spread(points: { x: number; y: number }[], of: { x: number; y: number }): number {
  return points.reduce((a, p) => a + Math.hypot(p.x - of.x, p.y - of.y), 0) / points.length;
}
