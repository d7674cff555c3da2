// What lies under a pointer: the pages around one pixel, drawn as places and normals.

import type { Mat4 } from "./camera";
import { UNFOLDED, link } from "./program";
import type { Vec3 } from "./protocol";

/** A place on the clay and the direction out of it, world coordinates. */
export interface Hit {
  place: Vec3;
  normal: Vec3;
}

const VERTEX = `#version 300 es
layout(location = 0) in vec3 place;
layout(location = 1) in vec2 folded;
uniform vec3 low;
uniform float step_;
uniform mat4 model, view;
out vec3 world, normal;
${UNFOLDED}
void main() {
  vec3 n = unfolded(folded);
  normal = mat3(model) * n;
  vec4 at = model * vec4(low + place * step_, 1.0);
  world = at.xyz;
  gl_Position = view * at;
}`;

// Bits of floats in whole numbers: every card draws those, few draw floats.
const FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
in vec3 world, normal;
layout(location = 0) out uvec4 place;
layout(location = 1) out uvec4 out_of;
void main() {
  place = uvec4(floatBitsToUint(world), 1u);
  out_of = uvec4(floatBitsToUint(normalize(gl_FrontFacing ? normal : -normal)), 1u);
}`;

/** A picture of one pixel. */
export class Picker {
  private readonly program: WebGLProgram;
  private readonly at: Record<string, WebGLUniformLocation | null> = {};
  private readonly target: WebGLFramebuffer;

  constructor(private readonly gl: WebGL2RenderingContext) {
    this.program = link(gl, VERTEX, FRAGMENT);
    for (const name of ["low", "step_", "model", "view"]) {
      this.at[name] = gl.getUniformLocation(this.program, name);
    }
    this.target = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    const attach = (point: number, format: number): void => {
      const buffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, format, 1, 1);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, point, gl.RENDERBUFFER, buffer);
    };
    attach(gl.COLOR_ATTACHMENT0, gl.RGBA32UI);
    attach(gl.COLOR_ATTACHMENT1, gl.RGBA32UI);
    attach(gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24);
    gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** `draw` draws the pages by the program whose uniforms it is given. */
  pick(
    view: Mat4,
    draw: (at: Record<string, WebGLUniformLocation | null>) => void,
  ): Hit | null {
    const gl = this.gl;
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.target);
    gl.viewport(0, 0, 1, 1);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferuiv(gl.COLOR, 1, [0, 0, 0, 0]);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.program);
    gl.uniformMatrix4fv(this.at.view ?? null, false, view);
    draw(this.at);
    const place = this.read(gl.COLOR_ATTACHMENT0);
    const normal = place && this.read(gl.COLOR_ATTACHMENT1);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return place && normal && { place, normal };
  }

  private read(attachment: number): Vec3 | null {
    const gl = this.gl;
    const bits = new Uint32Array(4);
    gl.readBuffer(attachment);
    gl.readPixels(0, 0, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, bits);
    const [x, y, z] = new Float32Array(bits.buffer);
    return bits[3] === 1 ? [x ?? 0, y ?? 0, z ?? 0] : null;
  }
}

/** The view with this point of it (-1 to 1) as the only pixel of `width` times `height`. */
export function aimed(view: Mat4, x: number, y: number, width: number, height: number): Mat4 {
  const m = new Float32Array(view);
  for (let column = 0; column < 16; column += 4) {
    const w = view[column + 3] ?? 0;
    m[column] = ((view[column] ?? 0) - x * w) * width;
    m[column + 1] = ((view[column + 1] ?? 0) - y * w) * height;
  }
  return m;
}
