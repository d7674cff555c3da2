// The controls around the clay: brush, undo, who is here, what goes on.

import type { Brush, Person, Role, Vec3, WallScale, WorkFormat } from "./protocol";
import { say, type Word } from "./text";

function the<T extends HTMLElement>(id: string): T {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page lacks #${id}`);
  return element as T;
}

export interface PanelEvents {
  brush(change: Partial<Brush>): void;
  undo(): void;
  redo(): void;
  home(): void;
  takeHome(format: WorkFormat): void;
  walls(on: boolean): void;
  name(name: string): void;
}

/** Radius of a brush by a slider from 0 to 1: fine where it is small. */
const RADII: [number, number] = [0.01, 0.6];

const hex = (c: Vec3): string => `#${c.map((v) => v.toString(16).padStart(2, "0")).join("")}`;
const css = (c: Vec3): string => `rgb(${c.join(" ")})`;

export class Panel {
  private readonly kind = the<HTMLSelectElement>("kind");
  private readonly radius = the<HTMLInputElement>("radius");
  private readonly strength = the<HTMLInputElement>("strength");
  private readonly colour = the<HTMLInputElement>("colour");
  private readonly negative = the<HTMLButtonElement>("negative");
  private readonly mirror = the<HTMLButtonElement>("mirror");
  private readonly finger = the<HTMLButtonElement>("finger");
  private readonly walls = the<HTMLButtonElement>("walls");
  private readonly follow = the<HTMLButtonElement>("follow");
  private readonly take = the<HTMLDetailsElement>("take");
  readonly name = the<HTMLInputElement>("name");
  private readonly note = the<HTMLParagraphElement>("note");
  private noteTimer = 0;

  constructor(events: PanelEvents) {
    const label = (id: string, word: Word): void => {
      const element = the(id);
      const text = element.closest("label")?.querySelector("span");
      if (text) text.textContent = say(word);
      else element.textContent = say(word);
    };
    const words: Word[] = [
      "kind", "radius", "strength", "colour", "negative", "mirror", "finger", "undo", "redo", "home", "walls", "follow",
      "takeHome", "glb", "stl",
    ];
    for (const word of words) label(word, word);
    the("tools").setAttribute("aria-label", say("tools"));
    the("clay").setAttribute("aria-label", say("title"));
    const [least, most] = RADII;
    this.kind.onchange = () => events.brush({ kind: this.kind.value });
    this.radius.oninput = () =>
      events.brush({ radius: least * (most / least) ** Number(this.radius.value) });
    this.strength.oninput = () => events.brush({ strength: Number(this.strength.value) });
    this.colour.oninput = () => {
      const value = Number.parseInt(this.colour.value.slice(1), 16);
      events.brush({ colour: [value >> 16, (value >> 8) & 255, value & 255] });
    };
    const toggle = (button: HTMLButtonElement, act: (on: boolean) => void): void => {
      button.onclick = () => {
        const on = !isPressed(button);
        press(button, on);
        act(on);
      };
    };
    toggle(this.negative, (on) => events.brush({ negative: on }));
    toggle(this.mirror, (on) => events.brush({ symmetry: [on, false, false] }));
    toggle(this.finger, () => {});
    toggle(this.walls, (on) => events.walls(on));
    toggle(this.follow, () => {});
    this.name.placeholder = say("name");
    this.name.setAttribute("aria-label", say("name"));
    this.name.onchange = () => events.name(this.name.value);
    the("undo").onclick = events.undo;
    the("redo").onclick = events.redo;
    the("home").onclick = events.home;
    for (const format of ["glb", "stl"] as const) {
      the(format).onclick = () => {
        this.take.open = false;
        events.takeHome(format);
      };
    }
  }

  get fingerSculpts(): boolean {
    return isPressed(this.finger);
  }

  /** A pen is here: from now on fingers move the view, unless the button says otherwise. */
  penSeen(): void {
    if (!this.finger.hidden) return;
    this.finger.hidden = false;
    press(this.finger, false);
  }

  get asksWalls(): boolean {
    return isPressed(this.walls);
  }

  /** The legend of the map of walls; null: no map is shown. */
  showWalls(scale: WallScale | null): void {
    the("legend").hidden = scale === null;
    if (!scale) return;
    const { low, high, measured } = scale;
    [high, (low + high) / 2, low].forEach((value, i) => {
      const mark = the("marks").children[i];
      if (mark) mark.textContent = millimetres(value);
    });
    the("legendTitle").textContent = measured < 1 ? `${say("walls")} · ${Math.floor(measured * 100)} %` : say("walls");
  }

  get follows(): boolean {
    return isPressed(this.follow);
  }

  set follows(on: boolean) {
    press(this.follow, on);
  }

  show(role: Role, brushes: string[]): void {
    the("tools").hidden = this.walls.hidden = role !== "sculptor";
    this.follow.hidden = the("home").hidden = this.take.hidden = role === "device";
    if (this.kind.options.length === 0) {
      for (const name of brushes) {
        const text = name.replaceAll("_", " ");
        this.kind.add(new Option(text.charAt(0).toUpperCase() + text.slice(1), name));
      }
    }
  }

  showBrush(brush: Brush): void {
    const [least, most] = RADII;
    this.kind.value = brush.kind;
    if (document.activeElement !== this.radius) {
      this.radius.value = String(Math.log(brush.radius / least) / Math.log(most / least));
    }
    if (document.activeElement !== this.strength) this.strength.value = String(brush.strength);
    this.colour.value = hex(brush.colour);
    press(this.negative, brush.negative);
    press(this.mirror, brush.symmetry[0]);
  }

  showPeople(people: Person[], own: number): void {
    // Oneself is the field of the name.
    const others = people.filter((p) => p.guest !== own);
    const items = others.map((p) => {
      const item = document.createElement("li");
      item.textContent = p.name || p.role;
      item.style.setProperty("--colour", css(p.colour));
      return item;
    });
    the("people").replaceChildren(...items);
  }

  state(text: string): void {
    the("state").textContent = text;
  }

  /** Shows a sentence for a few seconds. */
  tell(text: string): void {
    this.note.textContent = text;
    this.note.hidden = false;
    clearTimeout(this.noteTimer);
    this.noteTimer = setTimeout(() => (this.note.hidden = true), 5000);
  }

  /** Shows a sentence for good: nothing follows. */
  end(text: string): void {
    clearTimeout(this.noteTimer);
    document.body.classList.add("ended");
    the("tools").hidden = true;
    this.note.textContent = text;
    this.note.hidden = false;
  }
}

/** A length with as many places as its size needs. */
function millimetres(value: number): string {
  const digits = Math.min(3, Math.max(0, 2 - Math.floor(Math.log10(Math.max(value, 1e-3) * 1.0001))));
  return `${value.toLocaleString(undefined, { minimumFractionDigits: digits, maximumFractionDigits: digits })} mm`;
}

function isPressed(button: HTMLButtonElement): boolean {
  return button.getAttribute("aria-pressed") === "true";
}

function press(button: HTMLButtonElement, on: boolean): void {
  button.setAttribute("aria-pressed", String(on));
}
