// The page: joins the daemon that gave it out, shows its clay and lets a pen sculpt it.

import { circle, eye, project, slid, turned, viewHeight, viewProjection, zoomed } from "./camera";
import { ClayPicture } from "./clay";
import { Connection, pageTime } from "./connection";
import { ExpectedDabs } from "./expected";
import { Hand } from "./hand";
import { Panel } from "./panel";
import type { Hit } from "./pick";
import type { Brush, Camera, OthersPen, Person, Role, ShownObject, Tell, Vec3 } from "./protocol";
import { say, setLanguage } from "./text";

const canvas = document.getElementById("clay") as HTMLCanvasElement;
const ring = document.querySelector("#ring polygon") as SVGPolygonElement;
const expected = new ExpectedDabs(document.getElementById("expected") as unknown as SVGElement);
const penLayer = document.getElementById("pens") as HTMLDivElement;

/** Camera of the clay's own material, linear enough for the eye. */
const CLAY: Vec3 = [0.86, 0.62, 0.46];

let role: Role = "viewer";
let camera: Camera | null = null;
let home: Camera | null = null;
let brush: Brush | null = null;
let own = 0;
let extent = 1;
let people: Person[] = [];
let pens: OthersPen[] = [];
let objects: ShownObject[] = [];
let dirty = true;
let cameraAsked = false;
let isConnected = false;
/** Where a pen or a mouse is over the canvas, in its pixels, and its pressure if it draws. */
let pointer: { at: [number, number]; draws: number | null } | null = null;
let isRingOld = false;
let wereExpected = false;
let isClayNew = false;
/** Triangles of all objects. */
let total = 0;
let isViewNew = true;

setLanguage();
document.title = "sculptd";

function start(): void {
  const key = location.hash.slice(1);
  const panel = new Panel({
    brush: (change) => connection?.ask({ do: "brush", at: pageTime(), ...change }),
    undo: () => undo(),
    redo: () => redo(),
    home: () => home && look(fitted(home)),
    takeHome: (format) => connection?.ask({ do: "file", format }),
    walls: (on) => connection?.ask({ do: "walls", on }),
    name: (name) => {
      localStorage.setItem("name", name);
      connection?.ask({ do: "name", name });
    },
  });
  if (!/^[0-9a-f]{32}$/.test(key)) {
    panel.end(say("noKey"));
    return;
  }
  let picture: ClayPicture;
  try {
    picture = new ClayPicture(canvas);
  } catch (e) {
    panel.end(e instanceof Error ? e.message : String(e));
    return;
  }
  panel.state(say("connecting"));
  const name = localStorage.getItem("name") ?? "";
  panel.name.value = name;
  const connection = new Connection(key, name, {
    tell: (message) => take(message),
    page: (message) => {
      picture.take(message);
      dirty = isClayNew = true;
    },
    connected: (yes) => {
      isConnected = yes;
      if (!yes) hand.lift();
      if (!yes) expected.clear();
      if (!yes && !document.body.classList.contains("ended")) panel.state(say("lost"));
      if (yes && camera) sendCamera();
    },
  });
  const undo = (): void => connection.ask({ do: "undo", at: pageTime() });
  const redo = (): void => connection.ask({ do: "redo", at: pageTime() });

  function take(message: Tell): void {
    switch (message.is) {
      case "welcome":
        role = message.role;
        own = message.guest;
        extent = message.extent;
        if (!camera) {
          home = message.camera;
          camera = fitted(home);
          if (role === "device") lieOver(home);
          sendCamera();
        }
        if (!message.resumed && objects.length > 0) {
          picture.list([]);
          objects = [];
        }
        if (!brush || !message.resumed) brush = message.brush;
        panel.show(role, message.brushes);
        panel.showBrush(brush);
        if (panel.asksWalls) connection.ask({ do: "walls", on: true });
        showState();
        break;
      case "refused":
        panel.end(message.why);
        panel.state("");
        break;
      case "objects":
        objects = message.objects;
        total = objects.reduce((sum, o) => sum + o.triangles, 0);
        picture.list(objects);
        picture.radius = reach(objects, extent);
        showState();
        break;
      case "host":
        home = message.camera;
        // A tablet lies over the view of the screen, edge on edge.
        if (role === "device") lieOver(home);
        else if (panel.follows && camera) look(fitted(home));
        break;
      case "people":
        people = message.people;
        panel.showPeople(people, own);
        break;
      case "walls":
        picture.scale = message.scale;
        panel.showWalls(message.scale);
        break;
      case "pens":
        pens = message.pens;
        break;
      case "brush":
        brush = message.brush;
        panel.showBrush(brush);
        break;
      // What follows is no other picture: the card is left to the clay that is on its way.
      case "file":
        return fetchFile(message.path);
      case "note":
        return panel.tell(message.text);
      case "complete":
        document.body.dataset.complete = String(message.bytes);
        return;
      case "taken":
        expected.taken(message.batch, performance.now());
        if (role === "device") showState();
        return;
    }
    dirty = true;
  }

  /** The view of the screen that this tablet lies over, in its proportions. */
  function lieOver(screen: Camera): void {
    camera = screen;
    document.body.classList.add("device");
    document.body.style.setProperty("--aspect", String(screen.aspect));
  }

  function showState(): void {
    const what = { viewer: "watching", sculptor: "sculpting", device: "tablet" } as const;
    const total = objects.reduce((sum, o) => sum + o.vertices, 0);
    const figure =
      role === "device"
        ? `${connection.roundTrip.toFixed(0)} ms`
        : `${total.toLocaleString()} ${say("vertices")}`;
    panel.state(`${say(what[role])} · ${figure}`);
  }

  /** The view of the guest: from here on, strokes go through it. */
  function look(next: Camera): void {
    if (role === "device") return;
    camera = next;
    dirty = isViewNew = true;
    cameraAsked = true;
  }

  function sendCamera(): void {
    if (camera) connection.ask({ do: "camera", camera, at: pageTime() });
    cameraAsked = false;
  }

  const hand = new Hand(canvas, {
    camera: () => camera ?? fallback(),
    look: (next) => {
      panel.follows = false;
      look(next);
    },
    extent: () => extent,
    isClayAt: (x, y) => {
      if (role === "device" || !camera) return role === "device";
      return picture.pick(camera, x / canvas.clientWidth, y / canvas.clientHeight) !== null;
    },
    pen: (bytes) => {
      // A stroke through a view that the daemon does not know yet would go elsewhere.
      if (cameraAsked) sendCamera();
      return isConnected && connection.pen(bytes);
    },
    canSculpt: () => role !== "viewer" && isConnected,
    fingerSculpts: () => role === "device" || panel.fingerSculpts,
    penSeen: () => panel.penSeen(),
    pointerAt: (event, draws) => {
      const box = canvas.getBoundingClientRect();
      // Where the browser expects the pen to be by the time that this is shown.
      const soon = event?.getPredictedEvents?.().at(-1) ?? event;
      const pressure = event && draws ? (event.pointerType === "pen" ? event.pressure : 0.5) : null;
      pointer = soon && { at: [soon.clientX - box.left, soon.clientY - box.top], draws: pressure };
      isRingOld = true;
    },
    undo,
    redo,
  });

  addEventListener("keydown", (event) => {
    const onField = event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement;
    if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z") {
      event.preventDefault();
      (event.shiftKey ? redo : undo)();
      return;
    }
    if (onField || event.ctrlKey || event.metaKey || event.altKey || !camera) return;
    const step = 0.04;
    const move = event.shiftKey ? slid : turned;
    const moves: Record<string, () => Camera> = {
      ArrowLeft: () => move(camera ?? fallback(), -step, 0),
      ArrowRight: () => move(camera ?? fallback(), step, 0),
      ArrowUp: () => move(camera ?? fallback(), 0, -step),
      ArrowDown: () => move(camera ?? fallback(), 0, step),
      "+": () => zoomed(camera ?? fallback(), 1.1, extent),
      "-": () => zoomed(camera ?? fallback(), 1 / 1.1, extent),
    };
    const act = moves[event.key];
    if (act) {
      event.preventDefault();
      look(act());
    } else if (brush && (event.key === "[" || event.key === "]")) {
      const radius = brush.radius * (event.key === "]" ? 1.1 : 1 / 1.1);
      connection.ask({ do: "brush", at: pageTime(), radius });
    } else if (brush && event.key.toLowerCase() === "x") {
      connection.ask({ do: "brush", at: pageTime(), negative: !brush.negative });
    }
  });

  function draw(): void {
    if (!camera) return;
    const view = picture.draw(camera, CLAY);
    const dots = pens.flatMap((pen) => {
      const at = project(view, pen.position);
      if (!at) return [];
      const dot = document.createElement("span");
      const colour = people.find((p) => p.person === pen.person)?.colour ?? [255, 255, 255];
      dot.style.setProperty("--colour", `rgb(${colour.join(" ")})`);
      dot.style.left = `${canvas.offsetLeft + at[0] * canvas.clientWidth}px`;
      dot.style.top = `${canvas.offsetTop + at[1] * canvas.clientHeight}px`;
      dot.classList.toggle("down", pen.down);
      return [dot];
    });
    penLayer.replaceChildren(...dots);
    drawRing(camera);
  }

  function drawRing(camera: Camera): void {
    isRingOld = false;
    if (role !== "sculptor" || !isConnected || !pointer || !brush) {
      ring.setAttribute("points", "");
      return;
    }
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const hit = picture.pick(camera, pointer.at[0] / width, pointer.at[1] / height);
    ring.setAttribute("points", ringPoints(hit, picture.radius, camera, pointer.at, brush));
    if (hit && pointer.draws !== null) {
      expected.add(hit, brush.radius * extent, pointer.draws, brush.negative, connection.lastBatch);
      pointer.draws = null;
    }
  }

  function drawExpected(camera: Camera): void {
    const view = viewProjection(camera, picture.radius);
    expected.draw(view, canvas.clientWidth, canvas.clientHeight, performance.now());
  }

  function frame(): void {
    if (cameraAsked) sendCamera();
    const arrives = picture.figures.triangles < total && !isViewNew;
    if (dirty && !document.hidden && picture.isDrawn && (!arrives || picture.isRested)) {
      isViewNew = false;
      dirty = false;
      draw();
      if (isClayNew) expected.clayShown(performance.now());
      isClayNew = false;
    } else if (isRingOld && camera && picture.isDrawn) {
      drawRing(camera);
    }
    if (camera && (expected.count > 0 || wereExpected)) {
      wereExpected = expected.count > 0;
      drawExpected(camera);
    }
    connection.acknowledge();
    requestAnimationFrame(frame);
  }

  function fit(): void {
    const scale = Math.min(devicePixelRatio || 1, 2);
    canvas.width = Math.max(1, Math.round(canvas.clientWidth * scale));
    canvas.height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (camera) look({ ...camera, aspect: aspect() });
    dirty = true;
  }

  new ResizeObserver(fit).observe(canvas);
  canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => {
    picture = new ClayPicture(canvas);
    objects = [];
    connection.forget();
  });
  // A hidden page draws no frames; what it receives is acknowledged all the same.
  setInterval(() => document.hidden && connection.acknowledge(), 200);
  fit();
  frame();
  Object.assign(window, {
    sculptd: {
      figures: () => picture.figures,
      scale: () => picture.scale,
      roundTrip: () => connection.roundTrip,
      camera: () => camera,
      connection,
      expected,
    },
  });
}

/** Lets the browser keep a file as it keeps others. */
function fetchFile(path: string): void {
  const link = document.createElement("a");
  link.href = path;
  link.download = path.slice(path.lastIndexOf("/") + 1);
  link.click();
}

/** The brush's ring: on the clay under the pointer, or upright beside it. */
function ringPoints(
  hit: Hit | null,
  radius: number,
  camera: Camera,
  [x, y]: [number, number],
  brush: Brush,
): string {
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const view = viewProjection(camera, radius);
  const around = hit && circle(hit.place, hit.normal, brush.radius * extent);
  const flat = (brush.radius * extent * height) / viewHeight(camera);
  const points = Array.from({ length: 48 }, (_, n) => {
    const [cos, sin] = [Math.cos((n * Math.PI) / 24), Math.sin((n * Math.PI) / 24)];
    const at = around && project(view, around(cos, sin));
    return at ? [at[0] * width, at[1] * height] : [x + flat * cos, y + flat * sin];
  });
  return points.map((p) => p.map((v) => v.toFixed(1)).join(",")).join(" ");
}

function aspect(): number {
  return canvas.clientWidth / Math.max(1, canvas.clientHeight);
}

/** The view of another screen on this one: what fits there across fits here too. */
function fitted(camera: Camera): Camera {
  const narrow = Math.max(1, Math.min(camera.aspect, 1) / aspect());
  return { ...camera, aspect: aspect(), distance: camera.distance * narrow };
}

function fallback(): Camera {
  return {
    target: [0, 0, 0], yaw: 0, pitch: 0, distance: 3, fov_y: 0.698, aspect: aspect(), orthographic: false,
  };
}

/** How far the farthest object may reach from the target of a camera that shows the work. */
function reach(all: ShownObject[], extent: number): number {
  const from = camera ? eye(camera) : [0, 0, 0];
  const far = all.map((o) =>
    Math.hypot((o.matrix[12] ?? 0) - (from[0] ?? 0), (o.matrix[13] ?? 0) - (from[1] ?? 0), (o.matrix[14] ?? 0) - (from[2] ?? 0)),
  );
  return Math.max(extent * 2, ...far);
}

start();
