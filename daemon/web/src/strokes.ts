// SPDX-License-Identifier: MIT
// The strokes of a sheet: where they are, when they are cut, which one is meant. Pure.

import type { Strokes as SheetStrokes } from './model';

/** The strokes of a sheet, or lines of a design that are drawn like them, of kinds of their own. */
export type Strokes = Omit<SheetStrokes, 'kinds' | 'material' | 'side'> & { kinds: string[] };

/** Where each stroke's points begin in `xy_mm`, with one entry more. */
export function strokeStarts(strokes: Strokes): Int32Array {
  const counts = strokes.stroke.points;
  const out = new Int32Array(counts.length + 1);
  for (let i = 0; i < counts.length; i++) out[i + 1] = (out[i] as number) + 2 * (counts[i] as number);
  return out;
}

function distanceToSegment(x: number, y: number, ax: number, ay: number, bx: number, by: number): number {
  const dx = bx - ax;
  const dy = by - ay;
  const square = dx * dx + dy * dy;
  const t = square > 0 ? Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / square)) : 0;
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

/** The stroke nearest to a place on the sheet, or null if none is within `tolerance_mm`. */
export function strokeAt(strokes: Strokes, x: number, y: number, tolerance_mm: number): number | null {
  const starts = strokeStarts(strokes);
  const xy = strokes.xy_mm;
  let best: number | null = null;
  let least = tolerance_mm;
  for (let i = 0; i + 1 < starts.length; i++) {
    for (let p = starts[i] as number; p + 3 < (starts[i + 1] as number); p += 2) {
      const d = distanceToSegment(x, y, xy[p] as number, xy[p + 1] as number, xy[p + 2] as number, xy[p + 3] as number);
      if (d <= least) {
        least = d;
        best = i;
      }
    }
  }
  return best;
}

/** What a stroke is: its kind, which one of that kind it is, and how many there are. */
export function strokeNumber(strokes: Strokes, i: number): { kind: string; nth: number; of: number } {
  const kind = strokes.stroke.kind[i] ?? -1;
  let nth = 0;
  let of = 0;
  strokes.stroke.kind.forEach((other, k) => {
    if (other !== kind) return;
    of++;
    if (k <= i) nth++;
  });
  return { kind: strokes.kinds[kind] ?? 'other', nth, of };
}

/** How many strokes are begun at `time_s`, and how much of the last one is drawn. */
export function strokesAt(strokes: Strokes, time_s: number): { begun: number; share: number } {
  const { start_s, end_s } = strokes.stroke;
  let low = 0;
  let high = start_s.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((start_s[middle] as number) <= time_s) low = middle + 1;
    else high = middle;
  }
  if (low === 0) return { begun: 0, share: 1 };
  const from = start_s[low - 1] as number;
  const to = end_s[low - 1] as number;
  return { begun: low, share: to > from ? Math.min(1, (time_s - from) / (to - from)) : 1 };
}

/** When the last stroke ends, in s. */
export function endOf(strokes: Strokes | null): number {
  const ends = strokes?.stroke.end_s;
  return ends && ends.length > 0 ? (ends[ends.length - 1] as number) : 0;
}
