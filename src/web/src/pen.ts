// What a pen, a finger or a mouse does on the canvas, as records for the daemon
// (`devices/src/browser.rs` reads them).

import { pageTime } from "./connection";

const RECORD = 20;
const IN_RANGE = 1;
const TIP = 2;
const ERASER = 4;
const BARREL = 8;
const HAS_PRESSURE = 32;
const HAS_TILT = 64;

const KINDS: Record<string, number> = { pen: 0, mouse: 1, touch: 2 };

/** Lean to the right and toward the user, degrees. */
function tilt(event: PointerEvent): [number, number] {
  if (event.tiltX !== 0 || event.tiltY !== 0) return [event.tiltX, event.tiltY];
  const { altitudeAngle: altitude, azimuthAngle: azimuth } = event;
  if (altitude === undefined || altitude >= Math.PI / 2 || altitude <= 0) return [0, 0];
  const lean = 1 / Math.tan(altitude);
  const degrees = (share: number): number => (Math.atan(share * lean) * 180) / Math.PI;
  return [degrees(Math.cos(azimuth)), degrees(Math.sin(azimuth))];
}

/** Writes records of events, oldest first. `box`: the canvas on the screen. */
export function records(events: PointerEvent[], box: DOMRect, inRange: boolean): Uint8Array {
  const bytes = new Uint8Array(events.length * RECORD);
  const view = new DataView(bytes.buffer);
  const share = (value: number): number =>
    Math.round(Math.min(1, Math.max(0, value)) * 65535);
  events.forEach((event, i) => {
    const at = i * RECORD;
    const down = inRange && (event.buttons & 1) !== 0;
    const erases = (event.buttons & 32) !== 0;
    const isPen = event.pointerType === "pen";
    view.setFloat64(at, pageTime(event.timeStamp), true);
    view.setUint16(at + 8, share((event.clientX - box.left) / box.width), true);
    view.setUint16(at + 10, share((event.clientY - box.top) / box.height), true);
    view.setUint16(at + 12, share(event.pressure), true);
    const [right, toward] = isPen ? tilt(event) : [0, 0];
    view.setInt8(at + 14, Math.round(right));
    view.setInt8(at + 15, Math.round(toward));
    view.setUint16(at + 16, ((event.twist % 360) + 360) % 360, true);
    let bits = inRange ? IN_RANGE : 0;
    if (down || (inRange && erases)) bits |= TIP;
    if (erases) bits |= ERASER;
    if ((event.buttons & 2) !== 0 && isPen) bits |= BARREL;
    if (isPen) bits |= HAS_PRESSURE | HAS_TILT;
    view.setUint8(at + 18, bits);
    view.setUint8(at + 19, KINDS[event.pointerType] ?? 0);
  });
  return bytes;
}

/** An event and those that the browser merged into it. */
export function coalesced(event: PointerEvent): PointerEvent[] {
  const all = event.getCoalescedEvents?.() ?? [];
  return all.length > 0 ? all : [event];
}
