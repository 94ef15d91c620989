// SPDX-License-Identifier: MIT
// fold-guide.json of a design, read and laid out: pure.
import type { Part } from './lattice';

export type Point = [number, number];   // u, v on the sheet, mm

export interface GuideFold { from: Point; to: Point; sense: 'mountain' | 'valley' }

export interface GuideStep {
  kind: 'waste' | 'crease' | 'push' | 'fold' | 'slide' | 'glue';
  words: string;
  folds: number[];
  panels: number[];   // faces of the pattern
  look_from?: 'right' | 'left';   // from where the standing card shows them best
  /** Of a card of several parts: those that are there, the last ones come now. */
  standing?: string[];
  added?: string[];
  /** Tabs that are glued now, on the sheet that they are on or go on: outlines. */
  tabs?: { letter: string; outline: Point[]; isPlace: boolean }[];
}

/** A card of a book, or the only one. */
export interface GuideCard { name: string; folds: GuideFold[]; steps: GuideStep[] }

export interface Guide { cards: GuideCard[] }

/** The guide of a card of several parts: each has its own sheet; `folds` and outlines are (x, y) on it. */
export interface PartsGuide {
  name: string;
  parts: { name: string; waste: number; folds: GuideFold[] }[];
  tabs: { letter: string; part: string; on: string; outline_mm: Point[]; place_mm: Point[] }[];
  steps: { kind: 'fold' | 'slide' | 'glue'; part: string; with: string[]; words: string; folds: number[]; tabs: string[] }[];
}

/** The same as a guide of cards, a card for each part, its places on the page where the parts lie side by side. */
export function cardsOfParts(guide: PartsGuide, parts: readonly Part[]): { guide: Guide; steps: PlacedStep[] } {
  const number = (name: string): number => guide.parts.findIndex((one) => one.name === name);
  const placed = (part: number): ((at: Point) => Point) => {
    const [u, v] = parts[part]?.shift_mm ?? [0, 0];
    return ([x, y]) => [u - y, v + x];
  };
  const cards = guide.parts.map(({ name, folds }, part): GuideCard => {
    const to = placed(part);
    return { name, folds: folds.map((fold) => ({ ...fold, from: to(fold.from), to: to(fold.to) })), steps: [] };
  });
  let standing: string[] = [];
  const steps = guide.steps.map(({ kind, part, with: others, words, folds, tabs }): PlacedStep => {
    const card = number(part);
    const added = kind === 'fold' ? [] : [part, ...others];
    // What slides together stands alone until it is glued on the first part, which is the card.
    standing = [...new Set([...(kind === 'glue' ? [guide.parts[0]?.name ?? ''] : []), ...standing, ...added])];
    const glued = guide.tabs.filter(({ letter }) => tabs.includes(letter)).flatMap((tab) => [
      { letter: tab.letter, outline: tab.outline_mm.map(placed(number(tab.part))), isPlace: false },
      { letter: tab.letter, outline: tab.place_mm.map(placed(number(tab.on))), isPlace: true },
    ]);
    return { card, step: { kind, words, folds, panels: [], standing, added, tabs: glued } };
  });
  return { guide: { cards }, steps };
}

/** A step of a card, and the numbers of both. */
export interface PlacedStep { card: number; step: GuideStep }

/** All steps, card by card. */
export function stepsOf(guide: Guide): PlacedStep[] {
  return guide.cards.flatMap(({ steps }, card) => steps.map((step) => ({ card, step })));
}

/** left, top, width, height on the page: v to the right, u down. */
export type Box = [number, number, number, number];

/** The box around points, with a margin of `share` of its longer side, mm; null for no point. */
export function boxAround(points: readonly Point[], share: number): Box | null {
  if (points.length === 0) return null;
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [u, v] of points) {
    [left, right] = [Math.min(left, v), Math.max(right, v)];
    [top, bottom] = [Math.min(top, u), Math.max(bottom, u)];
  }
  const margin = Math.max(1, share * Math.max(right - left, bottom - top));
  return [left - margin, top - margin, right - left + 2 * margin, bottom - top + 2 * margin];
}

const kMostDigits = 1e3;
const text = ([u, v]: Point): string => `${Math.round(v * kMostDigits) / kMostDigits} ${Math.round(u * kMostDigits) / kMostDigits}`;

/** Lines as the `d` of a path. */
export const pathOf = (lines: Iterable<readonly [Point, Point]>): string =>
  [...lines].map(([from, to]) => `M${text(from)}L${text(to)}`).join('');

/** Triangles as the `d` of a path, from corners two numbers each: v, u. */
export function trianglesPath(corners: ArrayLike<number>): string {
  let out = '';
  for (let i = 0; i + 5 < corners.length; i += 6) {
    const at = (k: number): Point => [corners[i + 2 * k + 1] as number, corners[i + 2 * k] as number];
    out += `M${text(at(0))}L${text(at(1))}L${text(at(2))}Z`;
  }
  return out;
}
