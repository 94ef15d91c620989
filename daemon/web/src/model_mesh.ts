// SPDX-License-Identifier: MIT
// What the GPU is given of each corner of each triangle of a lattice, and the order of the triangles.
import { FaceKind, type Lattice } from './lattice';
import { cornerValues, mix, stopsOf, type Rgb, type Scale } from './ramps';

/** One entry for each corner, three corners a triangle. */
export interface Corners {
  /** x, z, v in mm. */
  position: Float32Array;
  /** Distance of the corner from the side across from it, mm. */
  height: Float32Array;
  /** How far along each of the three sides the corner lies, mm on the sheet. */
  along: Float32Array;
  /** Root of twice the area of the triangle, mm. */
  size: Float32Array;
  face: Float32Array;
  /** Slice, level (65535 for none), flags, roles: see paperVertexShader. */
  kinds: Uint16Array;
}

const kNone = 65535;
const kLit = 8;

export function cornersOf(lattice: Lattice): Corners {
  const { points, triangles, triangle_face, sides } = lattice;
  const m = triangle_face.length;
  const out: Corners = {
    position: new Float32Array(9 * m),
    height: new Float32Array(3 * m),
    along: new Float32Array(9 * m),
    size: new Float32Array(3 * m),
    face: new Float32Array(3 * m),
    kinds: new Uint16Array(12 * m),
  };
  const { position, height, along, size, face, kinds } = out;
  const wall = lattice.card.wall_mm;
  const us = new Float64Array(3);
  const vs = new Float64Array(3);
  for (let t = 0; t < m; t++) {
    for (let k = 0; k < 3; k++) {
      const i = 3 * (triangles[3 * t + k] as number);
      const x = points[i] as number;
      const z = points[i + 1] as number;
      const v = points[i + 2] as number;
      const at = 9 * t + 3 * k;
      position[at] = x;
      position[at + 1] = z;
      position[at + 2] = v;
      us[k] = x + wall - z;
      vs[k] = v;
    }
    const twice = twiceArea(us, vs);
    for (let k = 0; k < 3; k++) {
      const b = (k + 1) % 3;
      let du = (us[b] as number) - (us[k] as number);
      let dv = (vs[b] as number) - (vs[k] as number);
      const length = Math.sqrt(du * du + dv * dv) || 1e-9;
      // Dashes of a line that two triangles share begin at the same place.
      const sign = du < 0 || (du === 0 && dv < 0) ? -1 : 1;
      du *= sign / length;
      dv *= sign / length;
      height[3 * t + ((k + 2) % 3)] = twice / length;
      for (let j = 0; j < 3; j++) along[9 * t + 3 * j + k] = (us[j] as number) * du + (vs[j] as number) * dv;
    }
    const f = triangle_face[t] as number;
    const slice = lattice.face_slice[f] as number;
    const level = lattice.face_level[f] as number;
    const flags = (lattice.face_kind[f] as number) + (lattice.face_merged[f] ? 4 : 0);
    const roles = (sides[3 * t] as number) + 8 * (sides[3 * t + 1] as number) + 64 * (sides[3 * t + 2] as number);
    for (let c = 3 * t; c < 3 * t + 3; c++) {
      size[c] = Math.sqrt(twice);
      face[c] = f;
      kinds[4 * c] = slice < 0 ? kNone : slice;
      kinds[4 * c + 1] = level < 0 ? kNone : level;
      kinds[4 * c + 2] = flags;
      kinds[4 * c + 3] = roles;
    }
  }
  return out;
}

function twiceArea(us: ArrayLike<number>, vs: ArrayLike<number>): number {
  const [u0, u1, u2] = [us[0] as number, us[1] as number, us[2] as number];
  const [v0, v1, v2] = [vs[0] as number, vs[1] as number, vs[2] as number];
  return Math.abs((u1 - u0) * (v2 - v0) - (v1 - v0) * (u2 - u0));
}

/** Lights the corners of `faces` and no others. */
export function light({ kinds, face }: Pick<Corners, 'kinds' | 'face'>, faces: ReadonlySet<number>): void {
  for (let c = 0; c < face.length; c++) {
    const flags = (kinds[4 * c + 2] as number) % kLit;
    kinds[4 * c + 2] = flags + (faces.has(face[c] as number) ? kLit : 0);
  }
}

const kShades = 256;

/** The colour of the front at each corner, sRGB in bytes, four a corner: by value, or paper; merged levels amber. */
export function tintCorners(lattice: Lattice, scale: Scale, paper: Rgb, amber: Rgb, out: Uint8Array): void {
  const { triangle_face, face_merged, face_kind } = lattice;
  const stops = stopsOf(scale);
  // The last shade is paper.
  const shades = new Uint8Array(8 * (kShades + 1));
  for (let i = 0; i <= kShades; i++) {
    const colour = i < kShades ? mix(stops, i / (kShades - 1)) : paper;
    for (let k = 0; k < 3; k++) {
      shades[8 * i + k] = Math.round(255 * (colour[k] as number));
      shades[8 * i + 4 + k] = Math.round(255 * (0.28 * (colour[k] as number) + 0.72 * (amber[k] as number)));
    }
  }
  const values = new Float32Array(3 * triangle_face.length);
  cornerValues(lattice, scale, values);
  for (let c = 0; c < values.length; c++) {
    const face = triangle_face[Math.floor(c / 3)] as number;
    const value = values[c] as number;
    const merged = face_merged[face] && face_kind[face] === FaceKind.panel;
    const at = 8 * (value < 0 ? kShades : Math.min(kShades - 1, Math.round(value * (kShades - 1)))) + (merged ? 4 : 0);
    for (let k = 0; k < 3; k++) out[4 * c + k] = shades[at + k] as number;
  }
}

/** The triangles from small to large, in steps. */
export interface DrawOrder {
  triangles: Uint32Array;
  /** Triangles up to the end of each step. */
  ends: number[];
}

const kSteps = 64;

/** Small triangles first: near enough for leaving out what is too small to see. O(triangles). */
export function drawOrder(lattice: Lattice): DrawOrder {
  const m = lattice.triangle_face.length;
  const step = new Uint8Array(m);
  const count = new Uint32Array(kSteps);
  for (let t = 0; t < m; t++) {
    const k = Math.floor(4 * Math.log2(sizeOf(lattice, t)) + kSteps / 2);
    step[t] = Math.max(0, Math.min(kSteps - 1, k || 0));
    count[step[t] as number] = (count[step[t] as number] as number) + 1;
  }
  const ends: number[] = [];
  const next = new Uint32Array(kSteps);
  let sum = 0;
  for (let k = 0; k < kSteps; k++) {
    next[k] = sum;
    sum += count[k] as number;
    ends.push(sum);
  }
  const triangles = new Uint32Array(m);
  for (let t = 0; t < m; t++) {
    const k = step[t] as number;
    triangles[next[k] as number] = t;
    next[k] = (next[k] as number) + 1;
  }
  return { triangles, ends };
}

function sizeOf({ points, triangles, card }: Lattice, t: number): number {
  const us = [0, 0, 0];
  const vs = [0, 0, 0];
  for (let k = 0; k < 3; k++) {
    const i = 3 * (triangles[3 * t + k] as number);
    us[k] = (points[i] as number) + card.wall_mm - (points[i + 1] as number);
    vs[k] = points[i + 2] as number;
  }
  return Math.sqrt(twiceArea(us, vs));
}

/** The lattice with its triangles in that order; everything else is shared. */
export function ordered(lattice: Lattice, { triangles: order }: DrawOrder): Lattice {
  const m = order.length;
  const triangles = new Uint32Array(3 * m);
  const triangle_face = new Uint32Array(m);
  const sides = new Uint8Array(3 * m);
  for (let i = 0; i < m; i++) {
    const t = order[i] as number;
    triangle_face[i] = lattice.triangle_face[t] as number;
    for (let k = 0; k < 3; k++) {
      triangles[3 * i + k] = lattice.triangles[3 * t + k] as number;
      sides[3 * i + k] = lattice.sides[3 * t + k] as number;
    }
  }
  return { ...lattice, triangles, triangle_face, sides };
}

/** For each step of the order, the largest size of a triangle up to its end, mm. */
export function largestUpTo({ ends }: DrawOrder, size: Float32Array): number[] {
  let largest = 0;
  let t = 0;
  return ends.map((end) => {
    for (; t < end; t++) largest = Math.max(largest, size[3 * t] as number);
    return largest;
  });
}

/** Same triangles with the same corners: positions can be blended. */
export function sameTopology(a: Lattice, b: Lattice): boolean {
  if (a.motion !== 'pose' || b.motion !== 'pose') return false;
  if (a.triangles.length !== b.triangles.length || a.tips.length !== b.tips.length) return false;
  for (let i = 0; i < a.triangles.length; i++) if (a.triangles[i] !== b.triangles[i]) return false;
  return true;
}
