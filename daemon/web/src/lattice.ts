// SPDX-License-Identifier: MIT
// Reads the lattice blob (core/formats/lattice_blob): a design as triangles, with what the page
// needs to draw it at every opening angle. Strict: whatever does not agree throws one sentence.

/** Role of a triangle's side, and of a line on the sheet. */
export const Role = { inside: 0, cut: 1, mountain: 2, valley: 3, slit: 4 } as const;

/** What a face is part of. */
export const FaceKind = { panel: 0, wall: 1, ground: 2, other: 3 } as const;

export interface Place {
  slice?: number;
  level?: number;
  u_mm?: number;
  v_mm?: number;
}

export interface DesignWarning {
  code: string;
  message: string;
  place?: Place | null;
  spoils?: boolean;
}

/** A part of a card of several parts. A place (x, y) of its own sheet is at u = shift[0] - y, v = shift[1] + x here. */
export interface Part {
  name: string;
  folds: number;
  tabs: number;
  /** On the page: left, top, width, height (v, u). */
  box_mm: [number, number, number, number];
  shift_mm: [number, number];
}

export interface Lattice {
  quality: 'draft' | 'exact' | 'stored';
  method: string;
  name: string;
  kind: string;
  card: { wall_mm: number; ground_mm: number; width_mm: number; card: boolean };
  design_psi_rad: number;
  faces: number;
  report: Record<string, unknown>;
  warnings: DesignWarning[];
  error_mm: { max: number; at: Place | null } | null;
  motion: 'pose' | 'frames' | 'flat';
  judged: string[];
  not_judged: string[];
  /** x, z, v of each vertex, mm. Opened to psi it lies at (x + z cos psi, v, z sin psi). */
  points: Float32Array;
  triangles: Uint32Array;
  triangle_face: Uint32Array;
  sides: Uint8Array;
  face_kind: Uint8Array;
  face_slice: Int32Array;
  face_level: Int32Array;
  face_error: Float32Array;
  face_merged: Uint8Array;
  /** Of a card of several parts; else both are empty. */
  parts: Part[];
  face_part: Int32Array;
  point_k: Float32Array | null;
  point_h: Float32Array | null;
  /** Means over the corners of each face. */
  face_k: Float32Array | null;
  face_h: Float32Array | null;
  tips: Uint32Array;
  tip_apex: Float32Array;
  tip_w: Float32Array;
  tip_alpha: Float32Array;
  lines: Float32Array;
  line_role: Uint8Array;
  ghost_points: Float32Array;
  ghost_triangles: Uint32Array;
  /** World (X, V, Z) of each point, frame by frame, from flat to shut; empty unless motion is "frames". */
  frames: Float32Array;
  frame_psi: number[];
}

/** The blob does not agree with itself or with this page; the message says where. */
export class LatticeError extends Error {}

type Kind = 'f32' | 'u32' | 'i32' | 'u8';
const kBytes: Record<Kind, number> = { f32: 4, u32: 4, i32: 4, u8: 1 };

const kMostPoints = 4_000_000;

interface Entry {
  type: Kind;
  offset: number;
  length: number;
}

function fail(message: string): never {
  throw new LatticeError(`lattice: ${message}`);
}

function whole(value: unknown, what: string): number {
  if (typeof value !== 'number' || !Number.isInteger(value) || value < 0) fail(`${what} must be a whole number from 0`);
  return value as number;
}

function finite(value: unknown, what: string): number {
  if (typeof value !== 'number' || !Number.isFinite(value)) fail(`${what} must be a number`);
  return value as number;
}

function record(value: unknown, what: string): Record<string, unknown> {
  if (typeof value !== 'object' || value === null || Array.isArray(value)) fail(`${what} must be an object`);
  return value as Record<string, unknown>;
}

function words(value: unknown): string[] {
  return Array.isArray(value) ? value.filter((word): word is string => typeof word === 'string') : [];
}

/** The arrays of a blob: each checked against the bytes that are there before a view is made. */
class Arrays {
  private readonly table: Record<string, unknown>;
  private readonly buffer: ArrayBuffer;
  private readonly start: number;

  constructor(table: unknown, buffer: ArrayBuffer, start: number) {
    this.table = record(table, 'arrays');
    this.buffer = buffer;
    this.start = start;
  }

  has(name: string): boolean {
    return this.table[name] !== undefined;
  }

  private entry(name: string, type: Kind): Entry {
    const row = record(this.table[name], `the array "${name}"`);
    if (row['type'] !== type) fail(`the array "${name}" must be ${type}, not ${String(row['type'])}`);
    const offset = whole(row['offset'], `the offset of "${name}"`);
    const length = whole(row['length'], `the length of "${name}"`);
    if (offset % 4 !== 0) fail(`the array "${name}" must begin at a multiple of 4 bytes`);
    const room = this.buffer.byteLength - this.start;
    if (offset > room || length > (room - offset) / kBytes[type]) {
      fail(`the array "${name}" reaches past the end of the file`);
    }
    return { type, offset: this.start + offset, length };
  }

  f32(name: string): Float32Array {
    const e = this.entry(name, 'f32');
    return new Float32Array(this.buffer, e.offset, e.length);
  }

  u32(name: string): Uint32Array {
    const e = this.entry(name, 'u32');
    return new Uint32Array(this.buffer, e.offset, e.length);
  }

  i32(name: string): Int32Array {
    const e = this.entry(name, 'i32');
    return new Int32Array(this.buffer, e.offset, e.length);
  }

  u8(name: string): Uint8Array {
    const e = this.entry(name, 'u8');
    return new Uint8Array(this.buffer, e.offset, e.length);
  }
}

function same(array: { length: number }, length: number, name: string): void {
  if (array.length !== length) fail(`the array "${name}" has ${array.length} values where ${length} belong`);
}

function below(array: Uint32Array, limit: number, name: string): void {
  for (let i = 0; i < array.length; i++) {
    if ((array[i] as number) >= limit) fail(`"${name}"[${i}] is ${array[i]}, but there are only ${limit}`);
  }
}

function allFinite(array: Float32Array, name: string): void {
  for (let i = 0; i < array.length; i++) {
    if (!Number.isFinite(array[i])) fail(`"${name}"[${i}] is not a number`);
  }
}

function head(bytes: ArrayBuffer): { json: Record<string, unknown>; start: number } {
  if (bytes.byteLength < 12) fail('the file is shorter than its head of 12 bytes');
  const view = new DataView(bytes);
  const magic = String.fromCharCode(view.getUint8(0), view.getUint8(1), view.getUint8(2), view.getUint8(3));
  if (magic !== 'PCLB') fail('the file does not begin with PCLB');
  const version = view.getUint32(4, true);
  if (version !== 1) fail(`version ${version} is not known to this page; reload it`);
  const length = view.getUint32(8, true);
  if (length % 4 !== 0) fail('the length of its JSON must be a multiple of 4');
  if (length > bytes.byteLength - 12) fail('its JSON reaches past the end of the file');
  let json: unknown;
  try {
    json = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(new Uint8Array(bytes, 12, length)));
  } catch {
    fail('its JSON cannot be read');
  }
  return { json: record(json, 'its JSON'), start: 12 + length };
}

function oneOf<T extends string>(value: unknown, all: readonly T[], what: string): T {
  if (!all.includes(value as T)) fail(`${what} must be one of ${all.join(', ')}`);
  return value as T;
}

function warnings(value: unknown): DesignWarning[] {
  if (!Array.isArray(value)) return [];
  return value.map((each, i) => {
    const row = record(each, `warnings[${i}]`);
    return {
      code: typeof row['code'] === 'string' ? row['code'] : '',
      message: typeof row['message'] === 'string' ? row['message'] : '',
      place: (row['place'] ?? null) as Place | null,
      spoils: row['spoils'] === true,
    };
  });
}

function numbers(value: unknown, length: number, what: string): number[] {
  if (!Array.isArray(value) || value.length !== length) fail(`${what} must have ${length} numbers`);
  return (value as unknown[]).map((one) => finite(one, what));
}

function parts(value: unknown): Part[] {
  if (!Array.isArray(value)) return [];
  return value.map((each, i) => {
    const row = record(each, `parts[${i}]`);
    return {
      name: String(row['name']), folds: whole(row['folds'], 'folds'), tabs: whole(row['tabs'], 'tabs'),
      box_mm: numbers(row['box_mm'], 4, 'box_mm') as Part['box_mm'], shift_mm: numbers(row['shift_mm'], 2, 'shift_mm') as Part['shift_mm'],
    };
  });
}

function worst(value: unknown): Lattice['error_mm'] {
  if (value === undefined || value === null) return null;
  const row = record(value, 'error_mm');
  if (typeof row['max'] !== 'number') return null;
  return { max: finite(row['max'], 'error_mm.max'), at: (row['at'] ?? null) as Place | null };
}

/**
 * Reads a blob. The arrays are views of `bytes`: nothing is copied.
 * @throws LatticeError with one sentence where a length, an offset or an index does not agree.
 */
export function readLattice(bytes: ArrayBuffer): Lattice {
  const { json, start } = head(bytes);
  const arrays = new Arrays(json['arrays'], bytes, start);
  const card = record(json['card'], 'card');
  const motion = oneOf(json['motion'], ['pose', 'frames', 'flat'] as const, 'motion');

  const points = arrays.f32('points');
  if (points.length % 3 !== 0) fail('"points" must have three values a vertex');
  const n = points.length / 3;
  if (n > kMostPoints) fail(`${n} vertices are more than the ${kMostPoints} that this page draws`);
  allFinite(points, 'points');

  const triangles = arrays.u32('triangles');
  if (triangles.length % 3 !== 0) fail('"triangles" must have three corners each');
  const m = triangles.length / 3;
  below(triangles, n, 'triangles');
  const triangle_face = arrays.u32('triangle_face');
  same(triangle_face, m, 'triangle_face');
  const faces = whole(json['faces'], 'faces');
  below(triangle_face, faces, 'triangle_face');
  const sides = arrays.u8('sides').subarray(0, 3 * m);
  same(sides, 3 * m, 'sides');
  for (let i = 0; i < sides.length; i++) if ((sides[i] as number) > 4) fail(`"sides"[${i}] is not a role`);

  const face = {
    kind: arrays.u8('face_kind').subarray(0, faces),
    slice: arrays.i32('face_slice'),
    level: arrays.i32('face_level'),
    error: arrays.f32('face_error'),
    merged: arrays.u8('face_merged').subarray(0, faces),
  };
  for (const [name, array] of Object.entries(face)) same(array, faces, `face_${name}`);

  const tips = arrays.has('tips') ? arrays.u32('tips') : new Uint32Array(0);
  below(tips, n, 'tips');
  const tip = tips.length > 0
    ? { apex: arrays.f32('tip_apex'), w: arrays.f32('tip_w'), alpha: arrays.f32('tip_alpha') }
    : { apex: new Float32Array(0), w: new Float32Array(0), alpha: new Float32Array(0) };
  same(tip.apex, 3 * tips.length, 'tip_apex');
  same(tip.w, tips.length, 'tip_w');
  same(tip.alpha, tips.length, 'tip_alpha');

  const lines = arrays.has('lines') ? arrays.f32('lines') : new Float32Array(0);
  if (lines.length % 4 !== 0) fail('"lines" must have four values each');
  allFinite(lines, 'lines');
  const line_role = (arrays.has('line_role') ? arrays.u8('line_role') : new Uint8Array(0)).subarray(0, lines.length / 4);
  same(line_role, lines.length / 4, 'line_role');

  const ghost_points = arrays.has('ghost_points') ? arrays.f32('ghost_points') : new Float32Array(0);
  const ghost_triangles = arrays.has('ghost_triangles') ? arrays.u32('ghost_triangles') : new Uint32Array(0);
  allFinite(ghost_points, 'ghost_points');
  below(ghost_triangles, ghost_points.length / 3, 'ghost_triangles');

  let frames = new Float32Array(0);
  let frame_psi: number[] = [];
  if (motion === 'frames') {
    frames = arrays.f32('frames') as Float32Array<ArrayBuffer>;
    const list = record(json['frames'], 'frames')['psi_rad'];
    if (!Array.isArray(list) || list.length < 2) fail('"frames" must name two poses or more');
    frame_psi = (list as unknown[]).map((psi, i) => finite(psi, `frames.psi_rad[${i}]`));
    for (let i = 1; i < frame_psi.length; i++) {
      if (!((frame_psi[i] as number) < (frame_psi[i - 1] as number))) fail('the poses must go from flat to shut');
    }
    same(frames, 3 * n * frame_psi.length, 'frames');
    allFinite(frames, 'frames');
  }

  const all_parts = parts(json['parts']);
  const face_part = all_parts.length > 0 ? arrays.i32('face_part') : new Int32Array(0);
  if (all_parts.length > 0) {
    same(face_part, faces, 'face_part');
    if (face_part.some((part) => part < 0 || part >= all_parts.length)) fail('"face_part" names a part that is not there');
  }

  const optional = (name: string, length = n): Float32Array | null => {
    if (!arrays.has(name)) return null;
    const values = arrays.f32(name);
    same(values, length, name);
    return values;
  };

  return {
    quality: oneOf(json['quality'], ['draft', 'exact', 'stored'] as const, 'quality'),
    method: typeof json['lattice'] === 'string' ? json['lattice'] : '',
    name: typeof json['name'] === 'string' ? json['name'] : '',
    kind: typeof json['kind'] === 'string' ? json['kind'] : 'spec',
    card: {
      wall_mm: finite(card['wall_mm'], 'card.wall_mm'),
      ground_mm: finite(card['ground_mm'], 'card.ground_mm'),
      width_mm: finite(card['width_mm'], 'card.width_mm'),
      card: card['card'] !== false,
    },
    design_psi_rad: finite(json['design_psi_rad'], 'design_psi_rad'),
    faces,
    report: json['report'] === undefined || json['report'] === null ? {} : record(json['report'], 'report'),
    warnings: warnings(json['warnings']),
    error_mm: worst(json['error_mm']),
    motion,
    judged: words(json['judged']),
    not_judged: words(json['not_judged']),
    points,
    triangles,
    triangle_face,
    sides,
    face_kind: face.kind,
    face_slice: face.slice,
    face_level: face.level,
    face_error: face.error,
    face_merged: face.merged,
    parts: all_parts,
    face_part,
    point_k: optional('point_k'),
    point_h: optional('point_h'),
    face_k: optional('face_k', faces),
    face_h: optional('face_h', faces),
    tips,
    tip_apex: tip.apex,
    tip_w: tip.w,
    tip_alpha: tip.alpha,
    lines,
    line_role,
    ghost_points,
    ghost_triangles,
    frames,
    frame_psi,
  };
}

/** Which poses to blend at `psi_rad`, for motion "frames": index of the first, and the share of the next. */
export function frameAt(frame_psi: readonly number[], psi_rad: number): { index: number; share: number } {
  const last = frame_psi.length - 1;
  if (last < 1 || psi_rad >= (frame_psi[0] as number)) return { index: 0, share: 0 };
  for (let i = 0; i < last; i++) {
    const from = frame_psi[i] as number;
    const to = frame_psi[i + 1] as number;
    if (psi_rad >= to) return { index: i, share: (from - psi_rad) / (from - to) };
  }
  return { index: last - 1, share: 1 };
}

/**
 * World places (X, V, Z) of all points at `psi_rad`, in mm: docs/geometry.md, section 2; tips of
 * V-folds as `posed_vertices` of core/pattern. The same formula as in the vertex shader, for the
 * 2D picture, for handles and for tests.
 */
export function posedPoints(lattice: Lattice, psi_rad: number): Float32Array {
  const { points } = lattice;
  const out = new Float32Array(points.length);
  if (lattice.motion === 'frames') {
    const { index, share } = frameAt(lattice.frame_psi, psi_rad);
    const a = index * points.length;
    const b = a + points.length;
    for (let i = 0; i < points.length; i++) {
      const from = lattice.frames[a + i] as number;
      out[i] = from + share * ((lattice.frames[b + i] as number) - from);
    }
    return out;
  }
  const c = Math.cos(psi_rad);
  const s = Math.sin(psi_rad);
  for (let i = 0; i < points.length; i += 3) {
    const x = points[i] as number;
    const z = points[i + 1] as number;
    out[i] = x + z * c;
    out[i + 1] = points[i + 2] as number;
    out[i + 2] = z * s;
  }
  for (let t = 0; t < lattice.tips.length; t++) {
    const w = lattice.tip_w[t] as number;
    const theta = 2 * Math.atan((lattice.tip_alpha[t] as number) * Math.cos(psi_rad / 2));
    const up = w * Math.sin(theta);
    const ax = lattice.tip_apex[3 * t] as number;
    const az = lattice.tip_apex[3 * t + 1] as number;
    const at = 3 * (lattice.tips[t] as number);
    out[at] = ax + az * c + up * Math.cos(psi_rad / 2);
    out[at + 1] = (lattice.tip_apex[3 * t + 2] as number) + w * Math.cos(theta);
    out[at + 2] = az * s + up * Math.sin(psi_rad / 2);
  }
  return out;
}

/** Sheet coordinates of a vertex, in mm: v to the right, u downward. */
export function onSheet(lattice: Lattice, point: number): [number, number] {
  const x = lattice.points[3 * point] as number;
  const z = lattice.points[3 * point + 1] as number;
  return [lattice.points[3 * point + 2] as number, x + lattice.card.wall_mm - z];
}
