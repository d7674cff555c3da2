// The messages between the page and the daemon; `src/daemon/web/messages.rs` is their other end.

export type Vec3 = [number, number, number];

export interface Camera {
  target: Vec3;
  yaw: number;
  pitch: number;
  distance: number;
  fov_y: number;
  aspect: number;
  orthographic: boolean;
}

export interface Brush {
  kind: string;
  radius: number;
  strength: number;
  negative: boolean;
  colour: Vec3;
  symmetry: [boolean, boolean, boolean];
}

export interface ShownObject {
  id: number;
  name: string;
  active: boolean;
  matrix: number[];
  pages: number;
  vertices: number;
  triangles: number;
  clay: number;
}

export interface Person {
  guest: number;
  person: number;
  name: string;
  role: Role;
  colour: Vec3;
}

export interface OthersPen {
  person: number;
  position: Vec3;
  radius: number;
  down: boolean;
}

export type Role = "viewer" | "sculptor" | "device";

export interface Welcome {
  is: "welcome";
  role: Role;
  guest: number;
  person: number;
  ticket: string;
  resumed: boolean;
  camera: Camera;
  brush: Brush;
  brushes: string[];
  extent: number;
  records: number;
}

export type Tell =
  | Welcome
  | { is: "refused"; why: string }
  | { is: "objects"; objects: ShownObject[] }
  | { is: "host"; camera: Camera }
  | { is: "people"; people: Person[] }
  | { is: "pens"; pens: OthersPen[] }
  | { is: "brush"; brush: Brush }
  | { is: "taken"; batch: number }
  | { is: "complete"; bytes: number }
  | { is: "file"; path: string }
  | { is: "walls"; scale: WallScale | null }
  | { is: "note"; text: string };

/** The scale of the map of wall thickness, millimetres. */
export interface WallScale {
  low: number;
  high: number;
  /** Share of the vertices that are measured. */
  measured: number;
}

export type WorkFormat = "glb" | "stl";

export type Ask =
  | { do: "file"; format: WorkFormat }
  | { do: "camera"; camera: Camera; at: number }
  | ({ do: "brush"; at: number } & Partial<Brush>)
  | { do: "name"; name: string }
  | { do: "walls"; on: boolean }
  | { do: "undo"; at: number }
  | { do: "redo"; at: number };

/** Kinds of binary messages to the daemon. */
export const PEN_BATCH = 1;
export const RECEIVED = 2;
export const ALIVE = 3;

/** A page of clay; see `src/daemon/web/page_code.rs`. */
export interface PageMessage {
  message: number;
  object: number;
  page: number;
  rows: number;
  coloured: boolean;
  /** Lower corner, upper corner and step, of a whole page. */
  box: Float32Array | null;
  /** Rows of a whole page, or runs of changed rows. */
  runs: { first: number; data: Uint8Array }[];
  triangles: Uint16Array | null;
  /** Values of a map, one a row, in steps; nothing else comes with them. */
  values: { step: number; data: Uint8Array } | null;
}

const HEAD = 16;

/** Bytes of one row. */
export function rowBytes(coloured: boolean): number {
  return coloured ? 12 : 8;
}

export function readPage(buffer: ArrayBuffer): PageMessage {
  const view = new DataView(buffer);
  const coloured = (view.getUint8(1) & 1) !== 0;
  const rows = view.getUint16(2, true);
  const [message, object, page] = [4, 8, 12].map((at) => view.getUint32(at, true)) as Vec3;
  const stride = rowBytes(coloured);
  const known = { message, object, page, rows, coloured };
  if (view.getUint8(0) === 1) {
    const count = view.getUint32(HEAD + 28, true);
    const at = HEAD + 32;
    const end = at + rows * stride;
    return {
      ...known,
      box: new Float32Array(buffer.slice(HEAD, HEAD + 28)),
      runs: [{ first: 0, data: new Uint8Array(buffer, at, rows * stride) }],
      triangles: new Uint16Array(buffer.slice(end, end + count * 6)),
      values: null,
    };
  }
  if (view.getUint8(0) === 3) {
    const values = { step: view.getFloat32(HEAD, true), data: new Uint8Array(buffer, HEAD + 4, rows * 2) };
    return { ...known, box: null, runs: [], triangles: null, values };
  }
  const runs = [];
  for (let at = HEAD; at < buffer.byteLength; ) {
    const [first, count] = [view.getUint16(at, true), view.getUint16(at + 2, true)];
    runs.push({ first, data: new Uint8Array(buffer, at + 4, count * stride) });
    at += 4 + count * stride;
  }
  return { ...known, box: null, runs, triangles: null, values: null };
}
