// The turntable camera of the daemon (`src/engine/camera.rs`), and how a hand moves it.

import type { Camera, Vec3 } from "./protocol";

/** Just short of the poles: 89 degrees. */
const MAX_PITCH = 1.553343;

export type Mat4 = Float32Array;

const add = (a: Vec3, b: Vec3, s = 1): Vec3 => [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s];
const cross = (a: Vec3, b: Vec3): Vec3 => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const dot = (a: Vec3, b: Vec3): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const unit = (a: Vec3): Vec3 => {
  const length = Math.hypot(...a);
  return length > 0 ? [a[0] / length, a[1] / length, a[2] / length] : [1, 0, 0];
};

/** From the target to the eye, unit length. */
export function backward(c: Camera): Vec3 {
  const [sy, cy] = [Math.sin(c.yaw), Math.cos(c.yaw)];
  const [sp, cp] = [Math.sin(c.pitch), Math.cos(c.pitch)];
  return [sy * cp, sp, cy * cp];
}

export function eye(c: Camera): Vec3 {
  return add(c.target, backward(c), c.distance);
}

/** Right and up of the view. */
export function axes(c: Camera): [Vec3, Vec3] {
  const back = backward(c);
  const right = unit(cross([0, 1, 0], back));
  return [right, cross(back, right)];
}

/** World length of a whole view height at the target. */
export function viewHeight(c: Camera): number {
  return 2 * c.distance * Math.tan(c.fov_y / 2);
}

/** From the world to clip space, column by column. `radius`: of everything that is shown. */
export function viewProjection(c: Camera, radius: number): Mat4 {
  const [right, up] = axes(c);
  const back = backward(c);
  const from = eye(c);
  const far = c.distance + radius * 4;
  const near = Math.max(far / 5000, c.distance - radius * 4, c.distance / 1000);
  const height = Math.tan(c.fov_y / 2);
  const [sx, sy] = c.orthographic
    ? [2 / (viewHeight(c) * c.aspect), 2 / viewHeight(c)]
    : [1 / (height * c.aspect), 1 / height];
  const [zz, zw] = c.orthographic
    ? [-2 / (far - near), -(far + near) / (far - near)]
    : [-(far + near) / (far - near), (-2 * far * near) / (far - near)];
  const rows: [Vec3, number][] = [
    [right, -dot(right, from)],
    [up, -dot(up, from)],
    [back, -dot(back, from)],
  ];
  const m = new Float32Array(16);
  for (let i = 0; i < 3; i++) {
    m[i * 4] = sx * (rows[0]?.[0][i] ?? 0);
    m[i * 4 + 1] = sy * (rows[1]?.[0][i] ?? 0);
    m[i * 4 + 2] = zz * (rows[2]?.[0][i] ?? 0);
    m[i * 4 + 3] = c.orthographic ? 0 : -(rows[2]?.[0][i] ?? 0);
  }
  const z = rows[2]?.[1] ?? 0;
  m[12] = sx * (rows[0]?.[1] ?? 0);
  m[13] = sy * (rows[1]?.[1] ?? 0);
  m[14] = zz * z + zw;
  m[15] = c.orthographic ? 1 : -z;
  return m;
}

/** Place of a world point in the view, 0 to 1 from the top left; null behind the eye. */
export function project(m: Mat4, p: Vec3): [number, number] | null {
  const row = (i: number): number =>
    (m[i] ?? 0) * p[0] + (m[i + 4] ?? 0) * p[1] + (m[i + 8] ?? 0) * p[2] + (m[i + 12] ?? 0);
  const w = row(3);
  return w > 0 ? [(row(0) / w + 1) / 2, (1 - row(1) / w) / 2] : null;
}

/** Points of a circle in the world, by cosine and sine. */
export function circle(middle: Vec3, normal: Vec3, radius: number): (cos: number, sin: number) => Vec3 {
  const aside: Vec3 = Math.abs(normal[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0];
  const u = unit(cross(aside, normal));
  const v = cross(normal, u);
  return (cos, sin) => add(add(middle, u, cos * radius), v, sin * radius);
}

/** Turns by a drag over shares of the view's height. */
export function turned(c: Camera, dx: number, dy: number): Camera {
  const pitch = Math.min(MAX_PITCH, Math.max(-MAX_PITCH, c.pitch + dy * Math.PI));
  return { ...c, yaw: c.yaw - dx * Math.PI, pitch };
}

/** Slides by a drag over shares of the view's height: the clay follows the hand. */
export function slid(c: Camera, dx: number, dy: number): Camera {
  const [right, up] = axes(c);
  const step = viewHeight(c);
  return { ...c, target: add(add(c.target, right, -dx * step), up, dy * step) };
}

/** Comes nearer by a factor. */
export function zoomed(c: Camera, factor: number, extent: number): Camera {
  const distance = Math.min(extent * 100, Math.max(extent * 0.02, c.distance / factor));
  return { ...c, distance };
}
