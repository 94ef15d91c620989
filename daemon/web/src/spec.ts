// SPDX-License-Identifier: MIT
// A spec as the page changes it: pure functions from spec to spec, the steps that undo takes back,
// and the link that carries a spec. What a spec means is only decided by popcutd.
import type { Lattice } from './lattice';

export type Spec = Record<string, unknown>;

/** A spec from elsewhere that cannot be taken; the message says why. */
export class SpecError extends Error {}

const kMostUnits = 40;
const kMostSlices = 80;
/** More slices than anybody moves one by one; such a spec is only sent to popcutd, which refuses it. */
const kMostWidths = 10_000;
const kUndoSteps = 200;
/** What a link may hold, and what may come out of it. */
export const kMostLinkBytes = 8_000;
export const kMostSpecBytes = 256 * 1024;

function isRecord(value: unknown): value is Record<string, unknown> {
  return typeof value === 'object' && value !== null && !Array.isArray(value);
}

export function isSpec(value: unknown): value is Spec {
  return isRecord(value) && value['popcut'] === 1;
}

/** Reads a spec from text. Throws SpecError. */
export function parseSpec(text: string): Spec {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    throw new SpecError('not-json');
  }
  if (isSpec(value)) return value;
  throw new SpecError(isRecord(value) && typeof value['popcut'] === 'number' && value['popcut'] > 1 ? 'newer' : 'not-a-spec');
}

export const nameOf = (spec: Spec): string => (typeof spec['name'] === 'string' ? spec['name'] : '');

const numberIn = (value: unknown): number | null => (typeof value === 'number' && Number.isFinite(value) ? value : null);

const round = (value: number, digits = 3): number => {
  const f = 10 ** digits;
  return Math.round(value * f) / f;
};

/** True if the spec says units, slices and widths once for all, so that sliders can set them. */
export function isPlain(spec: Spec): boolean {
  return isRecord(spec['surface']) && !Array.isArray(spec['regions']) && !Array.isArray(spec['patches']);
}

export const isSilhouette = (spec: Spec): boolean => spec['style'] === 'silhouette';
export const isFacets = (spec: Spec): boolean => spec['style'] === 'facets';

/** Cards of several parts: of layers, of crossing slices, or of boxes. */
export type PartsStyle = 'layers' | 'slices' | 'boxes';
export const isPartsStyle = (style: unknown): style is PartsStyle => style === 'layers' || style === 'slices' || style === 'boxes';
export const isOfParts = (spec: Spec): boolean => isPartsStyle(spec['style']);

const kLatticeOnly = ['units_per_slice', 'slices', 'widths_mm', 'lattice', 'fit', 'splay', 'curvature', 'design_angle_deg'];
const kTriangles = ['mesh', 'grid', 'text', 'outline'];

/** Styles of large panels and of layers; each keeps its fields in an object of its own name. */
export type PanelStyle = 'facets' | 'silhouette' | 'layers';
const kPanelStyles = ['facets', 'silhouette', 'layers'];
const kCornerOnly = ['translate_mm', 'card', 'min_panel_mm', 'sheet', 'book'];   // not of what stands on two pages

/** Whether the shape has an inside, so that it can be sliced. */
export const isSolid = (spec: Spec): boolean => isRecord(spec['surface']) && ['mesh', 'text', 'outline'].includes(String(spec['surface']['type']));

/** The same shape as layers, slices or boxes. */
export function asParts(spec: Spec, style: PartsStyle): Spec {
  const out = asPanels(spec, 'layers');
  for (const field of [...kCornerOnly, ...(style === 'layers' ? [] : ['layers'])]) delete out[field];
  return { ...out, style };
}

/** The same shape as facets or layers; what only other styles have is left out. Its length stays. */
export function asPanels(spec: Spec, style: PanelStyle): Spec {
  const out: Spec = { ...spec, style };
  const before = kPanelStyles.includes(String(spec['style'])) ? spec[String(spec['style'])] : undefined;
  for (const field of [...kLatticeOnly, ...kPanelStyles, 'sliceform', 'boxes']) delete out[field];
  const surface = spec['surface'];
  if (isRecord(surface) && kTriangles.includes(String(surface['type']))) return out;
  if (isRecord(before) && typeof before['length_mm'] === 'number') {
    out[style] = { ...(typeof before['from_mm'] === 'number' ? { from_mm: before['from_mm'] } : {}), length_mm: before['length_mm'] };
    return out;
  }
  const widths = widthsOf(spec);
  const along = widths ? widths.reduce((sum, w) => sum + w, 0) : 100;
  out[style] = { from_mm: widths ? -(widths[0] as number) / 2 : 0, length_mm: along };
  return out;
}

/** The same shape as a lattice of ten slices. */
export function asLattice(spec: Spec): Spec {
  const out: Spec = { ...spec, units_per_slice: 6, slices: 10, widths_mm: 10, fit: 'nearest' };
  const panels = spec['facets'] ?? spec['silhouette'] ?? spec['layers'];
  if (isRecord(panels) && typeof panels['length_mm'] === 'number') out['widths_mm'] = round(panels['length_mm'] / 10, 3);
  for (const field of ['style', ...kPanelStyles, 'sliceform', 'boxes']) delete out[field];
  return out;
}

export const unitsOf = (spec: Spec): number | null => (isPlain(spec) ? numberIn(spec['units_per_slice']) : null);
export const slicesOf = (spec: Spec): number | null => (isPlain(spec) ? numberIn(spec['slices']) : null);

/** The width of each slice, mm, where all have the same. */
export const widthOf = (spec: Spec): number | null => (isPlain(spec) ? numberIn(spec['widths_mm']) : null);

/** Widths of all slices, mm, or null where they come from somewhere else. */
export function widthsOf(spec: Spec): number[] | null {
  const n = slicesOf(spec);
  const widths = spec['widths_mm'];
  if (n === null || n < 0 || n > kMostWidths) return null;
  if (typeof widths === 'number') return Array.from({ length: n }, () => widths);
  if (Array.isArray(widths) && widths.length === n && widths.every((w) => typeof w === 'number')) return widths as number[];
  return null;
}

export function withField(spec: Spec, field: string, value: unknown): Spec {
  const out = { ...spec };
  if (value === undefined || value === null || value === '') delete out[field];
  else out[field] = value;
  return out;
}

export const withUnits = (spec: Spec, n: number): Spec =>
  withField(spec, 'units_per_slice', Math.max(1, Math.min(kMostUnits, Math.round(n))));

/** Other number of slices over the same length: widths follow. */
export function withSlices(spec: Spec, n: number): Spec {
  const next = Math.max(1, Math.min(kMostSlices, Math.round(n)));
  const widths = widthsOf(spec);
  if (!widths) return withField(spec, 'slices', next);
  const length = widths.reduce((sum, w) => sum + w, 0);
  return { ...spec, slices: next, widths_mm: round(length / next, 4) };
}

/** The same width for all slices, mm. A radius by points is stretched along, so that it still reaches them all. */
export function withWidth(spec: Spec, width_mm: number): Spec {
  const next = round(Math.max(0.5, Math.min(500, width_mm)));
  const widths = widthsOf(spec);
  const before = widths ? widths.reduce((sum, w) => sum + w, 0) : 0;
  const out = withField(spec, 'widths_mm', next);
  return widths && before > 0 ? alongBy(out, (next * widths.length) / before) : out;
}

function alongBy(spec: Spec, factor: number): Spec {
  const points = radiusPoints(spec);
  if (!points || factor === 1) return spec;
  return withRadiusPoints(spec, points.map(([y, r]) => [round(y * factor, 2), r]));
}

/** The width of one slice, mm; the others stay. */
export function withSliceWidth(spec: Spec, slice: number, width_mm: number): Spec {
  const widths = widthsOf(spec);
  if (!widths || slice < 0 || slice >= widths.length) return spec;
  const next = widths.slice();
  next[slice] = round(Math.max(0.5, Math.min(500, width_mm)));
  return { ...spec, widths_mm: next.every((w) => w === next[0]) ? next[0] : next };
}

/** The shape and its slices, `factor` times as large. */
export function scaled(spec: Spec, factor: number): Spec {
  if (!(factor > 0) || !Number.isFinite(factor)) return spec;
  const out: Spec = { ...spec };
  const widths = spec['widths_mm'];
  if (typeof widths === 'number') out['widths_mm'] = round(widths * factor);
  else if (Array.isArray(widths)) out['widths_mm'] = widths.map((w) => (typeof w === 'number' ? round(w * factor) : w));
  const points = radiusPoints(spec);
  if (points && spec['scale_mm'] === undefined) {
    return withRadiusPoints(out, points.map(([y, r]) => [round(y * factor, 2), round(r * factor, 2)]));
  }
  out['scale_mm'] = round((numberIn(spec['scale_mm']) ?? 1) * factor, 5);
  const shift = spec['translate_mm'];
  if (Array.isArray(shift)) out['translate_mm'] = shift.map((v) => (typeof v === 'number' ? round(v * factor) : v));
  return out;
}

/** Widths of slices times `factor`; the shape stays, but for a radius by points, which is stretched along. */
export function stretched(spec: Spec, factor: number): Spec {
  const widths = widthsOf(spec);
  if (!widths || !(factor > 0)) return spec;
  const next = widths.map((w) => round(w * factor));
  return alongBy({ ...spec, widths_mm: next.every((w) => w === next[0]) ? next[0] : next }, factor);
}

export type RadiusPoint = [number, number];

/** The points (y, r) that the radius runs through, in the surface's own units, or null. */
export function radiusPoints(spec: Spec): RadiusPoint[] | null {
  const surface = spec['surface'];
  if (!isRecord(surface) || surface['type'] !== 'revolution' || !isRecord(surface['radius'])) return null;
  const points = surface['radius']['points'];
  if (!Array.isArray(points) || points.length < 2) return null;
  const ok = points.every((p) => Array.isArray(p) && p.length === 2 && numberIn(p[0]) !== null && numberIn(p[1]) !== null);
  return ok ? (points as RadiusPoint[]) : null;
}

/** True if the shape is one revolution, so that its silhouette can be dragged. */
export function isRevolution(spec: Spec): boolean {
  return isPlain(spec) && isRecord(spec['surface']) && spec['surface']['type'] === 'revolution'
    && spec['rotate_deg'] === undefined && spec['translate_mm'] === undefined;
}

export function withRadiusPoints(spec: Spec, points: RadiusPoint[]): Spec {
  const sorted = points.slice().sort((a, b) => a[0] - b[0]);
  return { ...spec, surface: { type: 'revolution', radius: { points: sorted } } };
}

/** One radius moved, mm of the surface's own units; never below 1. */
export function withRadius(spec: Spec, index: number, radius: number): Spec {
  const points = radiusPoints(spec);
  if (!points || !points[index]) return spec;
  const next = points.map((p, i): RadiusPoint => (i === index ? [p[0], round(Math.max(1, Math.min(2000, radius)), 2)] : p));
  return withRadiusPoints(spec, next);
}

/** A point added in the middle of the longest stretch beside `y`, or at `y` itself. */
export function withPointAt(spec: Spec, y: number, radius: number): Spec {
  const points = radiusPoints(spec);
  if (!points || points.length >= 64 || points.some((p) => Math.abs(p[0] - y) < 0.5)) return spec;
  return withRadiusPoints(spec, [...points, [round(y, 2), round(Math.max(1, radius), 2)]]);
}

export function withoutPoint(spec: Spec, index: number): Spec {
  const points = radiusPoints(spec);
  if (!points || points.length <= 2) return spec;
  return withRadiusPoints(spec, points.filter((_, i) => i !== index));
}

/** Where y = 0 of the shape lies along the sheet, mm: slices tell their place in both. */
export function sheetOffset(lattice: Lattice): number | null {
  const slices = lattice.report['slices'];
  const first = Array.isArray(slices) ? slices[0] : null;
  if (!isRecord(first)) return null;
  const s = numberIn(first['s_mm']);
  const v = numberIn(first['v_mm']);
  return s === null || v === null ? null : v - s;
}

/** How far the slices reach along the spine, mm of y, as wide as the spec says: from the first edge to the last. */
export function reachOf(lattice: Lattice): [number, number] | null {
  const slices = lattice.report['slices'];
  if (!Array.isArray(slices) || slices.length === 0) return null;
  const first = slices[0] as Record<string, unknown>;
  const last = slices[slices.length - 1] as Record<string, unknown>;
  const a = numberIn(first['s_mm']);
  const b = numberIn(last['s_mm']);
  if (a === null || b === null) return null;
  return [a - (numberIn(first['width_mm']) ?? 0) / 2, b + (numberIn(last['width_mm']) ?? 0) / 2];
}

/**
 * Radii of the target at `n` places along the spine, read off the target that popcutd drew: its
 * corners lie on the surface. In mm of y and r. Null where there is no target or it is no revolution.
 */
export function sampledRadii(lattice: Lattice, n: number): RadiusPoint[] | null {
  const offset = sheetOffset(lattice);
  const reach = reachOf(lattice);
  const { ghost_points } = lattice;
  if (offset === null || reach === null || ghost_points.length < 9) return null;
  const rings = new Map<number, { sum: number; count: number }>();
  for (let i = 0; i < ghost_points.length; i += 3) {
    const y = round((ghost_points[i + 1] as number) - offset, 3);
    const r = Math.hypot(ghost_points[i] as number, ghost_points[i + 2] as number);
    const ring = rings.get(y) ?? { sum: 0, count: 0 };
    ring.sum += r;
    ring.count++;
    rings.set(y, ring);
  }
  const sorted = [...rings].map(([y, ring]): RadiusPoint => [y, ring.sum / ring.count]).sort((a, b) => a[0] - b[0]);
  if (sorted.length < 2) return null;
  const [low, high] = reach;
  if (!(high > low)) return null;
  return Array.from({ length: n }, (_, i): RadiusPoint => {
    const y = low + ((high - low) * i) / (n - 1);
    return [round(y, 2), round(Math.max(1, interpolated(sorted, y)), 2)];
  });
}

/** The value at `y` on the chords between points; beyond the ends on the last chord. */
function interpolated(points: readonly RadiusPoint[], y: number): number {
  for (let i = 1; i < points.length; i++) {
    const [y0, r0] = points[i - 1] as RadiusPoint;
    const [y1, r1] = points[i] as RadiusPoint;
    if (y <= y1 || i === points.length - 1) return y1 > y0 ? r0 + ((r1 - r0) * (y - y0)) / (y1 - y0) : r1;
  }
  return (points[points.length - 1] as RadiusPoint)[1];
}

/** A drawn line as `n` points, evenly along its first coordinate, each the mean of what is near. */
export function evened(line: readonly (readonly [number, number])[], from: number, to: number, n: number): RadiusPoint[] {
  const sorted = line.map(([a, b]): RadiusPoint => [a, b]).sort((p, q) => p[0] - q[0]);
  const half = (to - from) / (n - 1) / 2;
  return Array.from({ length: n }, (_, i): RadiusPoint => {
    const at = from + ((to - from) * i) / (n - 1);
    const near = sorted.filter((p) => Math.abs(p[0] - at) <= half);
    const value = near.length > 0 ? near.reduce((sum, p) => sum + p[1], 0) / near.length : interpolated(sorted, at);
    return [round(at, 2), round(value, 2)];
  });
}

/** A line from wall to ground that only falls: x never shrinks and z never grows on the way. */
export function falling(line: readonly (readonly [number, number])[], n: number): RadiusPoint[] {
  const points = line.slice().sort((a, b) => a[0] - a[1] - (b[0] - b[1]));
  const out: [number, number][] = [];
  let x = 0;
  let z = Infinity;
  for (const [px, pz] of points) {
    x = Math.max(x, px);
    z = Math.min(z, pz);
    out.push([x, Math.max(0, z)]);
  }
  const step = Math.max(1, Math.floor(out.length / n));
  return out.filter((_, i) => i % step === 0 || i === out.length - 1).map(([a, b]): RadiusPoint => [round(a, 2), round(b, 2)]);
}

export interface Step {
  spec: Spec;
  what: string;
}

/**
 * The steps of one design: whole specs, newest last, the place among them, kept in `storage` so that
 * a reload loses nothing. One step for each gesture.
 */
export class Undo {
  private steps: string[] = [];
  private at = -1;
  private readonly storage: Storage | null;
  private readonly key: string;

  constructor(storage: Storage | null, key: string) {
    this.storage = storage;
    this.key = key;
    try {
      const kept = storage?.getItem(key);
      const value: unknown = kept ? JSON.parse(kept) : null;
      if (isRecord(value) && Array.isArray(value['steps']) && value['steps'].every((s) => typeof s === 'string')) {
        this.steps = value['steps'].slice(-kUndoSteps);
        this.at = Math.max(-1, Math.min(this.steps.length - 1, numberIn(value['at']) ?? -1));
      }
    } catch {
      this.steps = [];
      this.at = -1;
    }
  }

  get current(): Spec | null {
    const text = this.steps[this.at];
    return text === undefined ? null : (JSON.parse(text) as Spec);
  }

  get canUndo(): boolean {
    return this.at > 0;
  }

  get canRedo(): boolean {
    return this.at < this.steps.length - 1;
  }

  get length(): number {
    return this.steps.length;
  }

  push(spec: Spec): void {
    const text = JSON.stringify(spec);
    if (text === this.steps[this.at]) return;
    this.steps = [...this.steps.slice(0, this.at + 1), text].slice(-kUndoSteps);
    this.at = this.steps.length - 1;
    this.keep();
  }

  /** Puts `spec` in the place of the step that is shown. */
  amend(spec: Spec): void {
    if (this.at < 0) return;
    this.steps = [...this.steps.slice(0, this.at), JSON.stringify(spec), ...this.steps.slice(this.at + 1)];
    this.keep();
  }

  undo(): Spec | null {
    if (!this.canUndo) return null;
    this.at--;
    this.keep();
    return this.current;
  }

  redo(): Spec | null {
    if (!this.canRedo) return null;
    this.at++;
    this.keep();
    return this.current;
  }

  clear(): void {
    this.steps = [];
    this.at = -1;
    this.storage?.removeItem(this.key);
  }

  /** Keeps the newest steps that there is room for. */
  private keep(): void {
    let first = 0;
    while (this.storage && first <= this.at) {
      try {
        this.storage.setItem(this.key, JSON.stringify({ steps: this.steps.slice(first), at: this.at - first }));
        return;
      } catch {
        first += Math.max(1, (this.steps.length - first) >> 1);
      }
    }
  }
}

function toBase64url(bytes: Uint8Array): string {
  let text = '';
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

function fromBase64url(text: string): Uint8Array {
  if (!/^[A-Za-z0-9_-]*$/.test(text)) throw new SpecError('not-a-link');
  try {
    return Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), (c) => c.charCodeAt(0));
  } catch {
    throw new SpecError('not-a-link');
  }
}

async function gathered(stream: ReadableStream<Uint8Array>, most: number): Promise<Uint8Array> {
  const reader = stream.getReader();
  const parts: Uint8Array[] = [];
  let size = 0;
  for (;;) {
    let got: ReadableStreamReadResult<Uint8Array>;
    try {
      got = await reader.read();
    } catch {
      throw new SpecError('not-a-link');
    }
    if (got.done) break;
    size += got.value.length;
    if (size > most) {
      void reader.cancel().catch(() => undefined);
      throw new SpecError('too-large');
    }
    parts.push(got.value);
  }
  const out = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

function through(bytes: Uint8Array, transform: GenericTransformStream): ReadableStream<Uint8Array> {
  return new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(transform as ReadableWritablePair<Uint8Array, Uint8Array<ArrayBuffer>>);
}

/** What stands behind `#/design/d=` for this spec. Throws SpecError "too-large" beyond 8 kB, and "has-files" if it names a file. */
export async function shareText(spec: Spec): Promise<string> {
  const text = JSON.stringify(spec);
  if (/"file"\s*:/.test(text)) throw new SpecError('has-files');
  const bytes = await gathered(through(new TextEncoder().encode(text), new CompressionStream('deflate')), kMostSpecBytes);
  const out = toBase64url(bytes);
  if (out.length > kMostLinkBytes) throw new SpecError('too-large');
  return out;
}

/** The spec of a link. Refuses what is longer than a link may be, and what grows beyond a spec. Throws SpecError. */
export async function fromShare(text: string): Promise<Spec> {
  if (text.length > kMostLinkBytes) throw new SpecError('too-large');
  const bytes = await gathered(through(fromBase64url(text), new DecompressionStream('deflate')), kMostSpecBytes);
  let json: string;
  try {
    json = new TextDecoder('utf-8', { fatal: true }).decode(bytes);
  } catch {
    throw new SpecError('not-a-link');
  }
  const spec = parseSpec(json);
  if (/"file"\s*:/.test(json)) throw new SpecError('has-files');
  return spec;
}

/** The model that a design shows, the id of an asset; null: none. */
export function modelOf(spec: Spec | null): string | null {
  const surface = spec?.surface as { type?: unknown; file?: unknown } | undefined;
  return surface?.type === 'mesh' && typeof surface.file === 'string' && surface.file.startsWith('sha256-') ? surface.file : null;
}
