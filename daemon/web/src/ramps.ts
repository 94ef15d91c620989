// SPDX-License-Identifier: MIT
// Colours by value: error, curvature, panels. Lightness falls along the sequential ramp and away
// from the middle of the diverging one, so they can be read without seeing hues.
import type { Lattice } from './lattice';
import { FaceKind } from './lattice';

export type Colouring = 'paper' | 'error' | 'k' | 'h' | 'panel';

export type Rgb = readonly [number, number, number];

/** Five stops, sRGB 0..1. */
export const sequential: readonly Rgb[] = [
  [0.97, 0.94, 0.86],
  [0.96, 0.8, 0.47],
  [0.9, 0.56, 0.24],
  [0.73, 0.28, 0.18],
  [0.38, 0.07, 0.18],
];

export const diverging: readonly Rgb[] = [
  [0.09, 0.27, 0.55],
  [0.48, 0.66, 0.85],
  [0.96, 0.95, 0.92],
  [0.93, 0.66, 0.36],
  [0.6, 0.27, 0.04],
];

/** Neighbouring levels take neighbouring entries; chosen to differ in lightness as well as hue. */
export const categories: readonly Rgb[] = [
  [0.95, 0.9, 0.78],
  [0.62, 0.77, 0.86],
  [0.93, 0.74, 0.55],
  [0.6, 0.76, 0.62],
  [0.86, 0.68, 0.75],
];

export interface Scale {
  colouring: Colouring;
  kind: 'none' | 'log' | 'both' | 'names';
  /** Ends of the scale in `unit`. */
  low: number;
  high: number;
  unit: 'mm' | '1/mm²' | '1/mm' | '';
  ticks: { at: number; value: number }[];
}

/** The decade below and above, at least two of them: the ends of a log scale. */
function decades(max: number): [number, number] {
  const high = Number.isFinite(max) && max > 0 ? max : 1;
  return [high / 100, high];
}

/** Where `value` lies on a log scale, 0 to 1. */
export function logShare(value: number, low: number, high: number): number {
  if (!(value > low)) return 0;
  return Math.min(1, Math.log(value / low) / Math.log(high / low));
}

/** Where `value` lies on a scale with 0 in the middle, logarithmic to both sides, 0 to 1. */
export function bothShare(value: number, low: number, high: number): number {
  return 0.5 + 0.5 * Math.sign(value) * logShare(Math.abs(value), low, high);
}

/** Ends of the scale of errors: the largest, and a little below the smallest, two decades apart at most. */
function spread(lattice: Lattice): [number, number] {
  const [least, high] = decades(largest(lattice.face_error));
  let smallest = high;
  lattice.face_error.forEach((error, face) => {
    if (lattice.face_kind[face] === FaceKind.panel && error > 0 && error < smallest) smallest = error;
  });
  return [Math.max(least, Math.min(high / 4, 0.8 * smallest)), high];
}

function roundValues(low: number, high: number): number[] {
  const out: number[] = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); e++) {
    for (const m of [1, 2, 5]) {
      const value = m * 10 ** e;
      if (value >= low * 0.999 && value <= high * 1.001) out.push(value);
    }
  }
  if (out.length <= 4) return out;
  const decade = out.filter((value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9);
  return decade.length >= 2 ? decade : out.filter((_, i) => i % 2 === 0);
}

function largest(values: Float32Array | null): number {
  let max = 0;
  if (values) for (const value of values) if (Number.isFinite(value) && Math.abs(value) > max) max = Math.abs(value);
  return max;
}

/** K or H where they are known: means over faces if there are such, else at points. */
export function curvatures(lattice: Lattice, colouring: 'k' | 'h'): { faces: Float32Array | null; points: Float32Array | null } {
  return colouring === 'k' ? { faces: lattice.face_k, points: lattice.point_k } : { faces: lattice.face_h, points: lattice.point_h };
}

/** The scale of a colouring for this lattice: ends, unit and the ticks of its legend. */
export function scaleOf(lattice: Lattice, colouring: Colouring): Scale {
  if (colouring === 'error') {
    const [low, high] = spread(lattice);
    const ticks = roundValues(low, high).map((value) => ({ at: logShare(value, low, high), value }));
    return { colouring, kind: 'log', low, high, unit: 'mm', ticks };
  }
  if (colouring === 'k' || colouring === 'h') {
    const [low, high] = decades(largest(curvatures(lattice, colouring).faces ?? curvatures(lattice, colouring).points));
    const round = roundValues(low, high).slice(-1);
    const ticks = [
      ...round.map((value) => ({ at: bothShare(-value, low, high), value: -value })),
      { at: 0.5, value: 0 },
      ...round.map((value) => ({ at: bothShare(value, low, high), value })),
    ];
    return { colouring, kind: 'both', low, high, unit: colouring === 'k' ? '1/mm²' : '1/mm', ticks };
  }
  if (colouring === 'panel') return { colouring, kind: 'names', low: 0, high: 1, unit: '', ticks: [] };
  return { colouring, kind: 'none', low: 0, high: 1, unit: '', ticks: [] };
}

/** The share of each corner of each triangle on the scale; below 0: paper. Card and margins stay paper. */
export function cornerValues(lattice: Lattice, scale: Scale, out: Float32Array): void {
  const { triangles, triangle_face, face_kind, face_error, face_level, face_slice } = lattice;
  const of = scale.colouring === 'k' || scale.colouring === 'h' ? curvatures(lattice, scale.colouring) : null;
  for (let t = 0; t < triangle_face.length; t++) {
    const face = triangle_face[t] as number;
    const panel = face_kind[face] === FaceKind.panel;
    for (let k = 0; k < 3; k++) {
      let share = -1;
      if (panel && scale.kind === 'log') {
        const error = face_error[face] as number;
        if (Number.isFinite(error)) share = logShare(error, scale.low, scale.high);
      } else if (panel && scale.kind === 'both' && of) {
        const value = (of.faces ? of.faces[face] : of.points?.[triangles[3 * t + k] as number]) ?? NaN;
        if (Number.isFinite(value)) share = bothShare(value, scale.low, scale.high);
      } else if (panel && scale.kind === 'names') {
        const level = Math.max(0, face_level[face] as number);
        const slice = Math.max(0, face_slice[face] as number);
        share = ((2 * level + slice) % categories.length) / (categories.length - 1);
      }
      out[3 * t + k] = share;
    }
  }
}

export function mix(stops: readonly Rgb[], share: number): Rgb {
  const at = Math.min(1, Math.max(0, share)) * (stops.length - 1);
  const i = Math.min(stops.length - 2, Math.floor(at));
  const a = stops[i] as Rgb;
  const b = stops[i + 1] as Rgb;
  const f = at - i;
  return [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1]), a[2] + f * (b[2] - a[2])];
}

export function stopsOf(scale: Scale): readonly Rgb[] {
  return scale.kind === 'both' ? diverging : scale.kind === 'names' ? categories : sequential;
}

export function css(colour: Rgb): string {
  return `rgb(${colour.map((part) => Math.round(part * 255)).join(' ')})`;
}
