// SPDX-License-Identifier: MIT
// Cards of several parts: some parts alone, and all parts pulled apart. Pure.
import { frameAt, type Lattice, type Part } from './lattice';

/** The same card, of which only some parts are there. */
export function onlyParts(of: Lattice, parts: ReadonlySet<number>): Lattice {
  const kept: number[] = [];
  for (let t = 0; t < of.triangle_face.length; t++) if (parts.has(of.face_part[of.triangle_face[t] as number] as number)) kept.push(t);
  const three = (from: Uint32Array | Uint8Array): number[] => kept.flatMap((t) => [...from.subarray(3 * t, 3 * t + 3)]);
  const corners = three(of.triangles);
  const points = [...new Set(corners)];
  const number = new Map(points.map((point, i) => [point, i]));
  const places = (from: Float32Array, first: number): number[] => points.flatMap((i) => [...from.subarray(3 * (first + i), 3 * (first + i) + 3)]);
  const n = of.points.length / 3;
  return {
    ...of, triangles: Uint32Array.from(corners, (point) => number.get(point) as number), sides: Uint8Array.from(three(of.sides)),
    points: Float32Array.from(places(of.points, 0)), frames: Float32Array.from(of.frame_psi.flatMap((_, k) => places(of.frames, k * n))),
    triangle_face: Uint32Array.from(kept, (t) => of.triangle_face[t] as number),
  };
}

/** Which part each point belongs to. */
function partOfPoints(of: Lattice): Int32Array {
  const out = new Int32Array(of.points.length / 3);
  for (let i = 0; i < of.triangles.length; i++) {
    out[of.triangles[i] as number] = of.face_part[of.triangle_face[Math.floor(i / 3)] as number] as number;
  }
  return out;
}

const kApart = 0.9;

/** The same card with its parts pulled away from its pages, each in the direction in which it stands. */
export function apart(of: Lattice): Lattice {
  const part = partOfPoints(of);
  const n = part.length;
  const { index } = frameAt(of.frame_psi, of.design_psi_rad);
  const middle = of.parts.map(() => [0, 0, 0, 0]);
  for (let i = 0; i < n; i++) {
    const at = middle[part[i] as number] as number[];
    for (let k = 0; k < 3; k++) at[k] = (at[k] as number) + (of.frames[3 * (index * n + i) + k] as number);
    at[3] = (at[3] as number) + 1;
  }
  const centre = (p: number, k: number): number => ((middle[p] as number[])[k] as number) / Math.max(1, (middle[p] as number[])[3] as number);
  const frames = new Float32Array(of.frames.length);
  const lift_mm = Math.max(...of.parts.map((one) => one.box_mm[3])) / 4;
  for (let j = 0; j < frames.length; j++) {
    const p = part[Math.floor(j / 3) % n] as number;
    const k = j % 3;
    const away = p === 0 ? 0 : kApart * (centre(p, k) - centre(0, k)) + (k === 2 ? lift_mm : 0);
    frames[j] = (of.frames[j] as number) + away;
  }
  return { ...of, frames };
}

/** The number of the part with this name; -1: none. */
export const partNamed = (of: Lattice, name: string): number => of.parts.findIndex((one) => one.name === name);

/** Whether a line of the sheet lies on a part. */
export function isOn({ box_mm: [left, top, width, height] }: Part, u: number, v: number): boolean {
  const near = 0.01;
  return v >= left - near && v <= left + width + near && u >= top - near && u <= top + height + near;
}
