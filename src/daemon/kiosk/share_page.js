// Shows the visitor's work in 3-D, and deletes it on request. Reads the STL file that the page names.
"use strict";

const canvas = document.querySelector("canvas");

/** Corners and normals of a binary STL file, moved to the middle and scaled to a radius of 1. */
function triangles(bytes) {
  const view = new DataView(bytes);
  const count = view.getUint32(80, true);
  const corners = new Float32Array(count * 9);
  const normals = new Float32Array(count * 9);
  const lo = [Infinity, Infinity, Infinity];
  const hi = [-Infinity, -Infinity, -Infinity];
  for (let t = 0; t < count; t++) {
    for (let i = 0; i < 9; i++) {
      const value = view.getFloat32(84 + 50 * t + 12 + 4 * i, true);
      corners[9 * t + i] = value;
      lo[i % 3] = Math.min(lo[i % 3], value);
      hi[i % 3] = Math.max(hi[i % 3], value);
    }
  }
  const middle = [0, 1, 2].map((axis) => (lo[axis] + hi[axis]) / 2);
  const radius = Math.hypot(...[0, 1, 2].map((axis) => hi[axis] - lo[axis])) / 2 || 1;
  for (let i = 0; i < corners.length; i++) corners[i] = (corners[i] - middle[i % 3]) / radius;
  for (let t = 0; t < count; t++) {
    const at = (corner, axis) => corners[9 * t + 3 * corner + axis];
    const a = [0, 1, 2].map((axis) => at(1, axis) - at(0, axis));
    const b = [0, 1, 2].map((axis) => at(2, axis) - at(0, axis));
    const n = [0, 1, 2].map((k) => a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]);
    const length = Math.hypot(...n) || 1;
    for (let i = 0; i < 9; i++) normals[9 * t + i] = n[i % 3] / length;
  }
  return { count, corners, normals };
}

function program(gl) {
  const vertex = `attribute vec3 corner, normal; uniform mat3 turn; uniform vec2 scale; varying vec3 n;
    void main() { vec3 p = turn * corner; n = turn * normal;
      gl_Position = vec4(p.xy * scale, -p.z * 0.2, 1.0); }`;
  const fragment = `precision mediump float; varying vec3 n;
    void main() { float light = 0.35 + 0.65 * max(dot(normalize(n), normalize(vec3(0.3, 0.6, 0.8))), 0.0);
      gl_FragColor = vec4(vec3(0.80, 0.58, 0.48) * light, 1.0); }`;
  const made = gl.createProgram();
  for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  gl.useProgram(made);
  return made;
}

async function show() {
  const gl = canvas.getContext("webgl");
  const answer = await fetch(canvas.dataset.work);
  if (!gl || !answer.ok) return canvas.remove();
  const work = triangles(await answer.arrayBuffer());
  const made = program(gl);
  for (const [name, data] of [["corner", work.corners], ["normal", work.normals]]) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    const place = gl.getAttribLocation(made, name);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 0, 0);
  }
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(0.11, 0.12, 0.13, 1);
  const [turn, scale] = ["turn", "scale"].map((name) => gl.getUniformLocation(made, name));
  let [yaw, pitch, zoom, touched, before] = [0.5, 0.3, 0.95, false, 0];
  const pointers = new Map();
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  };
  const nearer = (factor) => { zoom = Math.min(Math.max(zoom * factor, 0.3), 8); };
  canvas.addEventListener("pointerdown", (e) => {
    touched = true;
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
  });
  canvas.addEventListener("pointermove", (e) => {
    const last = pointers.get(e.pointerId);
    if (!last) return;
    const wide = spread();
    pointers.set(e.pointerId, { x: e.clientX, y: e.clientY });
    if (pointers.size > 1) return nearer(spread() / (wide || 1));
    yaw += (e.clientX - last.x) * 0.01;
    pitch = Math.min(Math.max(pitch + (e.clientY - last.y) * 0.01, -1.5), 1.5);
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (e) => pointers.delete(e.pointerId));
  }
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    nearer(Math.exp(-e.deltaY * 0.001));
  });
  const draw = (now) => {
    if (!touched) yaw += Math.min(now - before, 100) * 0.0003;
    before = now;
    const dots = window.devicePixelRatio || 1;
    [canvas.width, canvas.height] = [canvas.clientWidth * dots, canvas.clientHeight * dots];
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const [sy, cy, sp, cp] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    gl.uniformMatrix3fv(turn, false, [cy, sp * sy, -cp * sy, 0, cp, sp, sy, -sp * cy, cp * cy]);
    const aspect = canvas.width / Math.max(canvas.height, 1);
    gl.uniform2f(scale, zoom * Math.min(1, 1 / aspect), zoom * Math.min(1, aspect));
    gl.drawArrays(gl.TRIANGLES, 0, work.count * 3);
    requestAnimationFrame(draw);
  };
  requestAnimationFrame(draw);
}

const remove = document.querySelector("button");
remove.addEventListener("click", async () => {
  if (!confirm(remove.dataset.sure)) return;
  const answer = await fetch(remove.dataset.at, { method: "POST" });
  const said = answer.ok ? remove.dataset.done : await answer.text();
  // What was not deleted stays on the page, to be tried again.
  if (answer.ok) document.body.textContent = said;
  else alert(said);
});

show();
