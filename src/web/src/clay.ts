// The clay on the graphics card: a vertex array for each page, drawn where it may be seen.

import { type Mat4, backward, viewProjection } from "./camera";
import { type Hit, Picker, aimed } from "./pick";
import { UNFOLDED, link } from "./program";
import type { Camera, PageMessage, ShownObject, WallScale } from "./protocol";
import { rowBytes } from "./protocol";

const VERTEX = `#version 300 es
layout(location = 0) in vec3 place;
layout(location = 1) in vec2 folded;
layout(location = 2) in vec4 paint;
layout(location = 3) in float wall;
uniform vec3 low;
uniform float step_;
uniform mat4 model, view;
uniform mat3 turn;
uniform float wall_step;
out vec3 normal;
out vec4 colour;
out vec2 thick;
${UNFOLDED}
void main() {
  vec3 n = unfolded(folded);
  normal = turn * mat3(model) * n;
  colour = paint;
  // The thickness, and whether it is known.
  thick = wall_step > 0.0 && wall < 65534.5 ? vec2(wall * wall_step, 1.0) : vec2(0.0);
  gl_Position = view * (model * vec4(low + place * step_, 1.0));
}`;

// A material as seen from the eye: a soft key from the upper left, sky, a warm bounce and a rim.
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 normal;
in vec4 colour;
in vec2 thick;
uniform vec3 clay;
// Low and high end, and 1 where walls are shown.
uniform vec3 scale;
uniform vec3 stops[5];
out vec4 pixel;
vec3 linear(vec3 c) { return pow(c, vec3(2.2)); }
void main() {
  vec3 n = normalize(gl_FrontFacing ? normal : -normal);
  float key = max(dot(n, normalize(vec3(-0.45, 0.6, 0.65))), 0.0);
  float sky = 0.5 + 0.5 * n.y;
  float rim = pow(1.0 - max(n.z, 0.0), 3.0);
  float shine = pow(max(dot(n, normalize(vec3(-0.3, 0.4, 0.85))), 0.0), 40.0);
  vec3 base = linear(clay) * linear(colour.rgb);
  base = mix(base, base * 0.35, colour.a);
  if (scale.z > 0.5) {
    float at = 4.0 * clamp((thick.x / max(thick.y, 1e-6) - scale.x) / max(scale.y - scale.x, 1e-12), 0.0, 1.0);
    int i = min(int(at), 3);
    base = thick.y > 0.5 ? linear(mix(stops[i], stops[i + 1], at - float(i))) : vec3(0.2);
  }
  vec3 light = vec3(0.16, 0.17, 0.20) * sky + vec3(0.10, 0.07, 0.05) * (1.0 - sky)
    + vec3(0.85, 0.82, 0.78) * key;
  vec3 lit = base * light + vec3(0.05) * shine + base * rim * 0.25;
  pixel = vec4(pow(lit, vec3(1.0 / 2.2)), 1.0);
}`;

/** Colours of walls from thin to thick, sRGB; `src/geometry/thickness/colour.rs` has them too. */
const STOPS = [[88, 0, 24], [176, 12, 32], [230, 85, 30], [252, 178, 72], [255, 250, 205]];

interface Page {
  array: WebGLVertexArrayObject;
  rows: WebGLBuffer;
  indices: WebGLBuffer;
  count: number;
  coloured: boolean;
  box: Float32Array;
  rowCount: number;
  walls: WebGLBuffer | null;
  /** Millimetres a step of the walls; 0: not known. */
  wallStep: number;
}

interface ClayObject {
  clay: number;
  matrix: Float32Array;
  pages: Map<number, Page>;
}

export class ClayPicture {
  private readonly gl: WebGL2RenderingContext;
  private readonly program: WebGLProgram;
  private readonly at: Record<string, WebGLUniformLocation | null> = {};
  private readonly objects = new Map<number, ClayObject>();
  private fence: WebGLSync | null = null;
  private picker: Picker | null = null;
  /** When the last picture was begun, and when it was seen to be finished, ms. */
  private begun = 0;
  private drawn = 0;
  /** The map of walls where it is shown. */
  scale: WallScale | null = null;
  /** Half the diagonal of everything, world units. */
  radius = 1;

  constructor(canvas: HTMLCanvasElement) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true });
    if (!gl) throw new Error("This browser has no WebGL 2.");
    this.gl = gl;
    this.program = link(gl, VERTEX, FRAGMENT);
    for (const name of ["low", "step_", "model", "view", "turn", "clay", "wall_step", "scale", "stops"]) {
      this.at[name] = gl.getUniformLocation(this.program, name);
    }
    gl.enable(gl.DEPTH_TEST);
  }

  /** Keeps what the list has, and forgets the rest. */
  list(objects: ShownObject[]): void {
    const gone = new Set(this.objects.keys());
    for (const shown of objects) {
      gone.delete(shown.id);
      let object = this.objects.get(shown.id);
      if (object && object.clay !== shown.clay) {
        this.forget(shown.id);
        object = undefined;
      }
      if (!object) {
        object = { clay: shown.clay, matrix: new Float32Array(16), pages: new Map() };
        this.objects.set(shown.id, object);
      }
      object.matrix.set(shown.matrix);
      for (const [number, page] of object.pages) {
        if (number >= shown.pages) {
          this.free(page);
          object.pages.delete(number);
        }
      }
    }
    for (const id of gone) this.forget(id);
  }

  take(message: PageMessage): void {
    const object = this.objects.get(message.object);
    if (!object) return;
    const gl = this.gl;
    let page = object.pages.get(message.page);
    if (message.box && message.triangles) {
      if (page) this.free(page);
      page = this.make(message, message.box, message.triangles);
      object.pages.set(message.page, page);
      return;
    }
    if (!page) return;
    if (message.values) return this.takeWalls(page, message.values);
    const stride = rowBytes(page.coloured);
    gl.bindBuffer(gl.ARRAY_BUFFER, page.rows);
    for (const run of message.runs) gl.bufferSubData(gl.ARRAY_BUFFER, run.first * stride, run.data);
  }

  private takeWalls(page: Page, { step, data }: { step: number; data: Uint8Array }): void {
    const gl = this.gl;
    if (data.length !== page.rowCount * 2) return;
    gl.bindVertexArray(page.array);
    page.walls ??= gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, page.walls);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(3);
    gl.vertexAttribPointer(3, 1, gl.UNSIGNED_SHORT, false, 2, 0);
    gl.bindVertexArray(null);
    page.wallStep = step;
  }

  private make(message: PageMessage, box: Float32Array, triangles: Uint16Array): Page {
    const gl = this.gl;
    const array = gl.createVertexArray();
    const [rows, indices] = [gl.createBuffer(), gl.createBuffer()];
    const stride = rowBytes(message.coloured);
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, rows);
    gl.bufferData(gl.ARRAY_BUFFER, message.runs[0]?.data ?? new Uint8Array(), gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.UNSIGNED_SHORT, false, stride, 0);
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 2, gl.BYTE, true, stride, 6);
    if (message.coloured) {
      gl.enableVertexAttribArray(2);
      gl.vertexAttribPointer(2, 4, gl.UNSIGNED_BYTE, true, stride, 8);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    const { coloured, rows: rowCount } = message;
    return { array, rows, indices, count: triangles.length, coloured, box, rowCount, walls: null, wallStep: 0 };
  }

  private free(page: Page): void {
    this.gl.deleteVertexArray(page.array);
    this.gl.deleteBuffer(page.rows);
    this.gl.deleteBuffer(page.walls);
    this.gl.deleteBuffer(page.indices);
  }

  private forget(id: number): void {
    for (const page of this.objects.get(id)?.pages.values() ?? []) this.free(page);
    this.objects.delete(id);
  }

  get isEmpty(): boolean {
    return [...this.objects.values()].every((o) => o.pages.size === 0);
  }

  /** Number of pages, of those with walls, and of triangles on the card. */
  get figures(): { pages: number; walls: number; triangles: number } {
    let [pages, walls, triangles] = [0, 0, 0];
    for (const object of this.objects.values()) {
      for (const page of object.pages.values()) {
        pages += 1;
        walls += page.wallStep > 0 ? 1 : 0;
        triangles += page.count / 3;
      }
    }
    return { pages, walls, triangles };
  }

  /** Whether the card has finished the last picture: a slow one gets no more than it can draw. */
  get isDrawn(): boolean {
    if (!this.fence) return true;
    const status = this.gl.getSyncParameter(this.fence, this.gl.SYNC_STATUS) as number;
    if (status !== this.gl.SIGNALED) return false;
    this.gl.deleteSync(this.fence);
    this.fence = null;
    this.drawn = performance.now();
    return true;
  }

  /** Whether the card may draw while clay arrives: it has to take that too. */
  get isRested(): boolean {
    return performance.now() - this.drawn > 3 * (this.drawn - this.begun);
  }

  draw(camera: Camera, clay: [number, number, number]): Mat4 {
    const gl = this.gl;
    const view = viewProjection(camera, this.radius);
    gl.viewport(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.uniformMatrix4fv(this.at.view ?? null, false, view);
    gl.uniformMatrix3fv(this.at.turn ?? null, false, toView(camera));
    gl.uniform3fv(this.at.clay ?? null, clay);
    const { low, high } = this.scale ?? { low: 0, high: 0 };
    gl.uniform3f(this.at.scale ?? null, low, high, this.scale ? 1 : 0);
    gl.uniform3fv(this.at.stops ?? null, STOPS.flat().map((v) => v / 255));
    // White, and no mask, where a page has no colours.
    gl.vertexAttrib4f(2, 1, 1, 1, 0);
    this.drawPages(view, this.at);
    if (this.fence) gl.deleteSync(this.fence);
    this.begun = this.drawn = performance.now();
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    return view;
  }

  /** The clay in front at this place of the view, 0 to 1 from the top left. */
  pick(camera: Camera, x: number, y: number): Hit | null {
    const view = viewProjection(camera, this.radius);
    const { drawingBufferWidth: width, drawingBufferHeight: height } = this.gl;
    const pixel = aimed(view, 2 * x - 1, 1 - 2 * y, width, height);
    this.picker ??= new Picker(this.gl);
    return this.picker.pick(pixel, (at) => this.drawPages(pixel, at));
  }

  /** Draws every page that this view may show, by the program in use. */
  private drawPages(view: Mat4, at: Record<string, WebGLUniformLocation | null>): void {
    const gl = this.gl;
    for (const object of this.objects.values()) {
      gl.uniformMatrix4fv(at.model ?? null, false, object.matrix);
      const clip = times(view, object.matrix);
      for (const page of object.pages.values()) {
        if (page.count === 0 || isOutside(clip, page.box)) continue;
        gl.uniform3fv(at.low ?? null, page.box.subarray(0, 3));
        gl.uniform1f(at.step_ ?? null, page.box[6] ?? 0);
        gl.uniform1f(at.wall_step ?? null, page.wallStep);
        gl.bindVertexArray(page.array);
        gl.drawElements(gl.TRIANGLES, page.count, gl.UNSIGNED_SHORT, 0);
      }
    }
    gl.bindVertexArray(null);
  }
}

/** From world directions to those of the view. */
function toView(camera: Camera): Float32Array {
  const [bx, by, bz] = backward(camera);
  const length = Math.hypot(bz, bx) || 1;
  const [rx, rz] = [bz / length, -bx / length];
  const [ux, uy, uz] = [by * rz, bz * rx - bx * rz, -by * rx];
  return new Float32Array([rx, ux, bx, 0, uy, by, rz, uz, bz]);
}

function times(a: Mat4, b: Mat4): Mat4 {
  const m = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      let sum = 0;
      for (let k = 0; k < 4; k++) sum += (a[k * 4 + row] ?? 0) * (b[column * 4 + k] ?? 0);
      m[column * 4 + row] = sum;
    }
  }
  return m;
}

/** All corners of the box are beyond one side of the view. */
function isOutside(clip: Mat4, box: Float32Array): boolean {
  let common = 0b11111;
  for (let corner = 0; corner < 8; corner++) {
    const [x, y, z] = [0, 1, 2].map(
      (i) => box[((corner >> i) & 1) * 3 + i] ?? 0,
    ) as [number, number, number];
    const row = (i: number): number =>
      (clip[i] ?? 0) * x + (clip[i + 4] ?? 0) * y + (clip[i + 8] ?? 0) * z + (clip[i + 12] ?? 0);
    const [cx, cy, w] = [row(0), row(1), row(3)];
    let beyond = 0;
    if (cx < -w) beyond |= 1;
    if (cx > w) beyond |= 2;
    if (cy < -w) beyond |= 4;
    if (cy > w) beyond |= 8;
    if (w < 0) beyond |= 16;
    common &= beyond;
    if (common === 0) return false;
  }
  return true;
}
