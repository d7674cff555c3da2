// A program of the graphics card, and what both of the page's have.

/** A direction from the two numbers of a row (octahedral). */
export const UNFOLDED = `vec3 unfolded(vec2 folded) {
  vec3 n = vec3(folded, 1.0 - abs(folded.x) - abs(folded.y));
  float under = max(-n.z, 0.0);
  return n + vec3(n.x >= 0.0 ? -under : under, n.y >= 0.0 ? -under : under, 0.0);
}`;

export function link(gl: WebGL2RenderingContext, vertex: string, fragment: string): WebGLProgram {
  const program = gl.createProgram();
  for (const [kind, text] of [
    [gl.VERTEX_SHADER, vertex],
    [gl.FRAGMENT_SHADER, fragment],
  ] as const) {
    const shader = gl.createShader(kind);
    if (!shader) throw new Error("The graphics card was lost.");
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
    throw new Error(`The picture cannot be drawn: ${gl.getProgramInfoLog(program) ?? ""}`);
  }
  return program;
}
