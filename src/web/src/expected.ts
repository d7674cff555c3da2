// The dabs that are expected: soft discs on the clay under a pen that draws, from the frame after
// its event until the clay that the daemon makes of it is shown.

import { type Mat4, circle, project } from "./camera";
import type { Hit } from "./pick";

/** Discs at a time; a line that is slower shows the newest. */
const MOST = 24;
/** A disc goes in this time once the clay is there, ms. */
const FADE_MS = 100;
/** Time after the answer in which clay must come, ms: a dab may have moved nothing. */
const CLAY_MS = 150;
/** Discs are this share of the radius apart, so that they do not add up. */
const APART = 0.3;
const CORNERS = 24;
const SVG = "http://www.w3.org/2000/svg";

interface ExpectedDab {
  hit: Hit;
  radius: number;
  /** 0 to 1. */
  pressure: number;
  negative: boolean;
  /** The batch that brings the daemon its sample. */
  batch: number;
  /** When the daemon had taken it, and when the clay was shown; 0: not yet. */
  taken: number;
  shown: number;
}

export class ExpectedDabs {
  private dabs: ExpectedDab[] = [];

  constructor(private readonly layer: SVGElement) {}

  get count(): number {
    return this.dabs.length;
  }

  add(hit: Hit, radius: number, pressure: number, negative: boolean, batch: number): void {
    const [before, last] = this.dabs.slice(-2);
    const isNear = before && last && Math.hypot(...last.hit.place.map((v, i) => v - (before.hit.place[i] ?? 0))) < radius * APART;
    // One that is close to the one before it gives way to the next.
    if (isNear && last.taken === 0) this.dabs.pop();
    this.dabs.push({ hit, radius, pressure, negative, batch, taken: 0, shown: 0 });
    if (this.dabs.length > MOST) this.dabs.shift();
  }

  /** The daemon has taken every batch up to this one. */
  taken(batch: number, now: number): void {
    for (const dab of this.dabs) if (dab.batch <= batch && dab.taken === 0) dab.taken = now;
  }

  /** The newest clay has been drawn. */
  clayShown(now: number): void {
    for (const dab of this.dabs) if (dab.taken > 0 && dab.shown === 0) dab.shown = now;
  }

  clear(): void {
    this.dabs = [];
  }

  draw(view: Mat4, width: number, height: number, now: number): void {
    for (const dab of this.dabs) if (dab.taken > 0 && dab.shown === 0 && now - dab.taken > CLAY_MS) dab.shown = now;
    this.dabs = this.dabs.filter((dab) => dab.shown === 0 || now - dab.shown < FADE_MS);
    while (this.layer.childElementCount > this.dabs.length) this.layer.lastElementChild?.remove();
    this.dabs.forEach((dab, i) => {
      let disc = this.layer.children[i];
      if (!disc) {
        disc = document.createElementNS(SVG, "polygon");
        this.layer.append(disc);
      }
      const around = circle(dab.hit.place, dab.hit.normal, dab.radius);
      const points = Array.from({ length: CORNERS }, (_, n) => {
        const turn = (n * 2 * Math.PI) / CORNERS;
        const at = project(view, around(Math.cos(turn), Math.sin(turn)));
        return at ? `${(at[0] * width).toFixed(1)},${(at[1] * height).toFixed(1)}` : "";
      });
      const left = dab.shown === 0 ? 1 : 1 - (now - dab.shown) / FADE_MS;
      disc.setAttribute("points", points.join(" "));
      disc.setAttribute("fill", dab.negative ? "url(#hollow)" : "url(#raised)");
      disc.setAttribute("opacity", (left * (0.25 + 0.5 * dab.pressure)).toFixed(2));
    });
  }
}
