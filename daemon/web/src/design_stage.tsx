// SPDX-License-Identifier: MIT
// The three-dimensional side of Design: the model, its handles, its legend.
import { computed, effect, signal, useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import * as desk from './design_desk';
import { mustAnswer } from './drawing';
import { FaceKind, posedPoints, type Lattice } from './lattice';
import { paintModel } from './model_paper';
import type { ModelView } from './model_view';
import { apart } from './parts_card';
import { css, curvatures, scaleOf, stopsOf, type Colouring, type Scale } from './ramps';
import * as searching from './search_desk';
import {
  isRevolution, radiusPoints, reachOf, sampledRadii, sheetOffset, stretched, withoutPoint, withPointAt, withRadius,
  withRadiusPoints, withSliceWidth, widthsOf, type RadiusPoint, type Spec,
} from './spec';
import { length } from './words';
import { designWords as words, small } from './words_design';

type Point = readonly [number, number, number];

/** The model that is shown now, for pictures and films; null without WebGL. */
export const shownModel: { view: ModelView | null } = { view: null };

/** Something to drag: its place for each value, and what a value does. */
interface Handle {
  id: string;
  kind: 'radius' | 'open' | 'length' | 'width';
  label: string;
  text: string;
  value: number;
  least: number;
  most: number;
  /** How much an arrow key changes, and with Shift. */
  step: number;
  fine: number;
  at: (value: number) => Point;
  set: (value: number, last: boolean) => void;
  remove?: () => void;
  add?: () => void;
}

/** A point of the section (X, Z) at v along the sheet, in the pose psi. */
function posedAt(x: number, z: number, v: number, psi: number): Point {
  return [x + z * Math.cos(psi), v, z * Math.sin(psi)];
}

function countOfPoints(of: Lattice): number {
  const reach = reachOf(of);
  return reach ? Math.max(4, Math.min(9, Math.round((reach[1] - reach[0]) / 16) + 1)) : 5;
}

/** The points of the silhouette as they can be dragged: the spec's own, or sampled off the drawn target. */
function silhouette(of: Lattice, spec: Spec): { points: RadiusPoint[]; own: boolean } | null {
  if (!isRevolution(spec)) return null;
  const own = radiusPoints(spec);
  if (own) return { points: own, own: true };
  const sampled = sampledRadii(of, countOfPoints(of));
  return sampled ? { points: sampled, own: false } : null;
}

/**
 * Where around the section the radii are dragged, as a share of the angle from ground to wall: by the
 * wall or by the ground, whichever the eye sees more from the side.
 */
const ridge = signal(0.87);

function ridgeFor(view: ModelView, of: Lattice, psi: number): number {
  const eye = view.towardsEye();
  const along = (share: number): number => {
    const [x, z] = onCircle(1, share, of.design_psi_rad);
    const way = posedAt(x, z, 0, psi);
    return Math.abs(way[0] * eye[0] + way[2] * eye[2]) / (Math.hypot(...way) || 1);
  };
  const now = ridge.peek();
  const other = 1 - now;
  // It changes only where that is much better: handles must not jump about.
  return along(other) < along(now) - 0.15 ? other : now;
}

/** The point (X, Z) of the section at distance r from the spine, at a share of the angle from ground to wall. */
function onCircle(r: number, share: number, designed: number): readonly [number, number] {
  const angle = share * designed;
  const z = (r * Math.sin(angle)) / Math.sin(designed);
  return [r * Math.cos(angle) - z * Math.cos(designed), z];
}

/** Points that were sampled in this gesture, so that the first drag of a formula goes on as points. */
let sampledFor: { spec: Spec; points: RadiusPoint[] } | null = null;

function radiusHandles(of: Lattice, spec: Spec): Handle[] {
  const offset = sheetOffset(of);
  const found = silhouette(of, spec);
  if (offset === null || !found) return [];
  if (!found.own) sampledFor = { spec, points: found.points };
  const scale = found.own && typeof spec.scale_mm === 'number' ? spec.scale_mm : 1;
  const share = ridge.value;
  const based = (): Spec => {
    const now = desk.spec.peek() ?? spec;
    if (radiusPoints(now)) return now;
    const points = sampledFor?.points ?? found.points;
    const plain = { ...now };
    delete plain.scale_mm;
    desk.note.value = words.handles.sampled(points.length);
    return withRadiusPoints(plain, points);
  };
  return found.points.map(([y, r], i): Handle => ({
    id: `radius-${i}`,
    kind: 'radius',
    label: words.handles.radius(i + 1, found.points.length, length(y * scale)),
    text: words.handles.radiusText(length(r * scale)),
    value: r * scale,
    least: 2,
    most: Math.max(60, r * scale * 2.5),
    step: 1,
    fine: 0.1,
    at: (value) => posedAt(...onCircle(value, share, of.design_psi_rad), y * scale + offset, desk.psi.peek()),
    set: (value, last) => {
      const next = withRadius(based(), i, value / scale);
      if (last) desk.set(next, `radius-${i}`, value);
      else desk.change(next, `radius-${i}`, value);
    },
    remove: found.points.length > 2 ? () => desk.set(withoutPoint(based(), i)) : undefined,
    add: () => {
      const all = radiusPoints(based()) ?? found.points;
      const other = all[i + 1] ?? all[i - 1];
      if (!other) return;
      desk.set(withPointAt(based(), ((all[i] as RadiusPoint)[0] + other[0]) / 2, ((all[i] as RadiusPoint)[1] + other[1]) / 2));
    },
  }));
}

function openHandle(of: Lattice): Handle | null {
  if (of.motion === 'flat' || !of.card.card) return null;
  return {
    id: 'open',
    kind: 'open',
    label: words.handles.open,
    text: words.psi.text((desk.psi.value * 180) / Math.PI),
    value: (desk.psi.value * 180) / Math.PI,
    least: 0,
    most: 180,
    step: 5,
    fine: 1,
    at: (degrees) => posedAt(0, of.card.wall_mm, of.card.width_mm / 2, (degrees * Math.PI) / 180),
    set: (degrees) => { desk.psi.value = (degrees * Math.PI) / 180; },
  };
}

function lengthHandle(of: Lattice, spec: Spec): Handle | null {
  const reach = reachOf(of);
  const offset = sheetOffset(of);
  if (!reach || offset === null || stretched(spec, 1) === spec) return null;
  const now = reach[1] - reach[0];
  return {
    id: 'length',
    kind: 'length',
    label: words.handles.length,
    text: length(now),
    value: now,
    least: 5,
    most: Math.max(200, now * 2.5),
    step: 1,
    fine: 0.1,
    at: (value) => posedAt(of.card.ground_mm * 0.62, 0, offset + reach[0] + value, desk.psi.peek()),
    set: (value, last) => {
      const current = desk.spec.peek();
      if (!current) return;
      const held = lengthOf(current);
      if (!(held > 0)) return;
      const next = stretched(current, value / held);
      if (last) desk.set(next, 'length', value);
      else desk.change(next, 'length', value);
    },
  };
}

const lengthOf = (spec: Spec): number => (widthsOf(spec) ?? []).reduce((sum, w) => sum + w, 0);

/** The section's place (X, Z) of a slice that is farthest out; null if it has no panel. */
function outermostOf(of: Lattice, slice: number): readonly [number, number] | null {
  let best: readonly [number, number] | null = null;
  let most = -Infinity;
  for (let t = 0; t < of.triangle_face.length; t++) {
    const face = of.triangle_face[t] as number;
    if (of.face_slice[face] !== slice || of.face_kind[face] !== FaceKind.panel) continue;
    for (let k = 0; k < 3; k++) {
      const p = 3 * (of.triangles[3 * t + k] as number);
      const [x, z] = [of.points[p] as number, of.points[p + 1] as number];
      if (x + z <= most) continue;
      most = x + z;
      best = [x, z];
    }
  }
  return best;
}

/** The far edge of the slice that is pressed: drags its width. */
function widthHandle(of: Lattice, spec: Spec): Handle | null {
  const pinned = desk.pinned.value;
  const slice = pinned?.kind === 'slice' ? pinned.slice : pinned?.kind === 'face' ? of.face_slice[pinned.face] as number : -1;
  const widths = widthsOf(spec);
  const width = widths?.[slice];
  const reach = reachOf(of);
  const offset = sheetOffset(of);
  const place = slice < 0 ? null : outermostOf(of, slice);
  if (!widths || width === undefined || !reach || offset === null || !place) return null;
  const begin = offset + reach[0] + widths.slice(0, slice).reduce((sum, w) => sum + w, 0);
  return {
    id: `width-${slice}`,
    kind: 'width',
    label: words.handles.width(slice + 1),
    text: length(width),
    value: width,
    least: 1,
    most: Math.max(40, width * 4),
    step: 1,
    fine: 0.1,
    at: (value) => posedAt(place[0], place[1], begin + value, desk.psi.peek()),
    set: (value, last) => {
      const now = desk.spec.peek();
      if (!now) return;
      const next = withSliceWidth(now, slice, value);
      if (last) desk.set(next, `width-${slice}`, value);
      else desk.change(next, `width-${slice}`, value);
    },
  };
}

function handlesOf(of: Lattice | null, spec: Spec | null): Handle[] {
  if (!of) return [];
  const out: Handle[] = spec ? radiusHandles(of, spec) : [];
  const length_ = spec ? lengthHandle(of, spec) : null;
  if (length_) out.push(length_);
  const width = spec ? widthHandle(of, spec) : null;
  if (width) out.push(width);
  const open = openHandle(of);
  if (open) out.push(open);
  return out;
}

/** The value whose place is nearest to the pointer on the screen. */
function nearestValue(handle: Handle, view: ModelView, x: number, y: number): { value: number; away: number } {
  const away = (value: number): number => {
    const p = view.project(...handle.at(value));
    return Math.hypot(p.x - x, p.y - y);
  };
  let best = handle.least;
  let least = Infinity;
  const n = 96;
  for (let i = 0; i <= n; i++) {
    const value = handle.least + ((handle.most - handle.least) * i) / n;
    const d = away(value);
    if (d < least) {
      least = d;
      best = value;
    }
  }
  let span = (handle.most - handle.least) / n;
  for (let i = 0; i < 12; i++) {
    span /= 2;
    for (const value of [best - span, best + span]) {
      if (value < handle.least || value > handle.most) continue;
      const d = away(value);
      if (d < least) {
        least = d;
        best = value;
      }
    }
  }
  return { value: best, away: least };
}

const kLetGo_px = 110;

function Handles({ view }: { view: ModelView }) {
  const box = useRef<HTMLDivElement>(null);
  const handles = handlesOf(desk.lattice.value, desk.spec.value);
  const list = useRef(handles);
  list.current = handles;
  const dragging = useRef<{ id: string; pointer: number; from: number; off: boolean } | null>(null);
  const letGo = useSignal<string | null>(null);

  const place = (): void => {
    const buttons = box.current?.children;
    if (!buttons) return;
    const of = desk.lattice.peek();
    if (of && !dragging.current) ridge.value = ridgeFor(view, of, desk.psi.peek());
    list.current.forEach((handle, i) => {
      const button = buttons[i] as HTMLElement | undefined;
      if (!button) return;
      const p = view.project(...handle.at(handle.kind === 'open' ? (desk.psi.peek() * 180) / Math.PI : handle.value));
      button.style.transform = `translate(${p.x.toFixed(1)}px, ${p.y.toFixed(1)}px)`;
    });
  };
  useEffect(() => { place(); });
  useEffect(() => {
    placeHandles.add(place);
    return () => { placeHandles.delete(place); };
  }, []);

  const find = (id: string): Handle | undefined => list.current.find((handle) => handle.id === id);
  const onDown = (event: PointerEvent, id: string): void => {
    const handle = find(id);
    if (!handle || event.button !== 0) return;
    (event.currentTarget as HTMLElement).setPointerCapture(event.pointerId);
    dragging.current = { id, pointer: event.pointerId, from: handle.value, off: false };
    desk.moving.value = handle.kind !== 'open';
    view.setTurning(false);
  };
  const onMove = (event: PointerEvent): void => {
    const drag = dragging.current;
    if (!drag || drag.pointer !== event.pointerId) return;
    const handle = find(drag.id);
    if (!handle) return;
    const frame = view.canvas.getBoundingClientRect();
    const { value, away } = nearestValue(handle, view, event.clientX - frame.left, event.clientY - frame.top);
    drag.off = away > kLetGo_px && handle.remove !== undefined && radiusPoints(desk.spec.peek() ?? {}) !== null;
    letGo.value = drag.off ? drag.id : null;
    if (!drag.off) handle.set(event.shiftKey ? Math.round(value * 10) / 10 : handle.kind === 'open' ? Math.round(value) : Math.round(value * 2) / 2, false);
  };
  const onUp = (event: PointerEvent): void => {
    const drag = dragging.current;
    if (!drag || drag.pointer !== event.pointerId) return;
    dragging.current = null;
    letGo.value = null;
    view.setTurning(true);
    const handle = find(drag.id);
    if (drag.off) handle?.remove?.();
    else if (handle && handle.kind !== 'open' && desk.moving.value) desk.settle();
    desk.moving.value = false;
  };
  const onKey = (event: KeyboardEvent, id: string): void => {
    const handle = find(id);
    if (!handle) return;
    const by = event.shiftKey ? handle.fine : handle.step;
    const way = event.key === 'ArrowUp' || event.key === 'ArrowRight' ? 1 : event.key === 'ArrowDown' || event.key === 'ArrowLeft' ? -1 : 0;
    if (way !== 0) {
      const next = Math.round((handle.value + way * by) * 100) / 100;
      handle.set(Math.max(handle.least, Math.min(handle.most * 2, next)), true);
    } else if (event.key === 'Delete' || event.key === 'Backspace') handle.remove?.();
    else if (event.key === 'Enter') handle.add?.();
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  return (
    <div ref={box} class="handles">
      {handles.map((handle) => (
        <button key={handle.id} type="button" class={`handle handle-${handle.kind}${letGo.value === handle.id ? ' handle-off' : ''}`}
          aria-label={`${handle.label}: ${handle.text}`} aria-description={words.handles.what} title={handle.text}
          data-value={handle.value.toFixed(2)}
          onPointerDown={(event) => onDown(event, handle.id)} onPointerMove={onMove} onPointerUp={onUp} onPointerCancel={onUp}
          onDblClick={() => handle.add?.()} onKeyDown={(event) => onKey(event, handle.id)}>
          <span class="handle-dot" />
          <span class="handle-text">{letGo.value === handle.id ? words.handles.letGo : handle.text}</span>
        </button>
      ))}
    </div>
  );
}

const placeHandles = new Set<() => void>();

function centreOf(of: Lattice, face: number, psi: number): Point {
  const places = posedPoints(of, psi);
  let [x, y, z, n] = [0, 0, 0, 0];
  for (let t = 0; t < of.triangle_face.length; t++) {
    if (of.triangle_face[t] !== face) continue;
    for (let k = 0; k < 3; k++) {
      const p = 3 * (of.triangles[3 * t + k] as number);
      x += places[p] as number;
      y += places[p + 1] as number;
      z += places[p + 2] as number;
      n++;
    }
  }
  return n > 0 ? [x / n, y / n, z / n] : [0, 0, 0];
}

/** The worst place, marked where it is. */
function Worst({ view }: { view: ModelView }) {
  const button = useRef<HTMLButtonElement>(null);
  const of = desk.lattice.value;
  const face = of && desk.colouring.value === 'error' ? desk.worstFace(of) : null;
  const place = (): void => {
    if (!button.current || !of || face === null) return;
    const p = view.project(...centreOf(of, face, desk.psi.peek()));
    button.current.style.transform = `translate(${p.x.toFixed(1)}px, ${p.y.toFixed(1)}px)`;
  };
  useEffect(() => {
    place();
    placeHandles.add(place);
    return () => { placeHandles.delete(place); };
  }, [of, face]);
  if (!of || face === null) return null;
  const error = of.face_error[face] as number;
  return (
    <button ref={button} type="button" class="worst" onClick={() => { desk.pinned.value = { kind: 'face', face }; }}>
      <span>{words.stage.worst(length(error))}</span>
    </button>
  );
}

export function Legend({ scale }: { scale: Scale }) {
  if (scale.kind !== 'log' && scale.kind !== 'both') {
    return scale.kind === 'names' ? <p class="legend-what">{words.stage.panelWhat}</p> : null;
  }
  const stops = stopsOf(scale);
  const what = scale.colouring === 'error' ? words.stage.errorWhat : scale.colouring === 'k' ? words.stage.kWhat : words.stage.hWhat;
  return (
    <figure class="legend">
      <svg viewBox="0 0 200 26" role="img" aria-label={`${what}: ${scale.ticks.map((tick) => small(tick.value)).join(', ')}`}>
        <defs>
          <linearGradient id="ramp" x1="0" x2="1" y1="0" y2="0">
            {stops.map((stop, i) => <stop key={i} offset={`${(100 * i) / (stops.length - 1)}%`} stop-color={css(stop)} />)}
          </linearGradient>
        </defs>
        <rect x="6" y="1" width="188" height="9" rx="2" fill="url(#ramp)" class="legend-bar" />
        {scale.ticks.map((tick) => (
          <g key={tick.value}>
            <line x1={6 + 188 * tick.at} x2={6 + 188 * tick.at} y1="10" y2="13.5" class="legend-tick" />
            <text x={6 + 188 * tick.at} y="23" text-anchor={tick.at < 0.05 ? 'start' : tick.at > 0.95 ? 'end' : 'middle'} class="legend-text">{small(tick.value)}</text>
          </g>
        ))}
      </svg>
      <figcaption>{what}</figcaption>
    </figure>
  );
}

function mergedAny(of: Lattice | null): boolean {
  return of !== null && of.face_merged.some((one) => one !== 0);
}

/** What is under the pointer or lit, in words. */
export function litWords(of: Lattice | null, which: desk.Lit | null): string {
  if (!of || !which) return '';
  if (which.kind === 'slice') {
    const error = desk.errorsBy(of).slices.get(which.slice) ?? -1;
    return `${words.figures.slice(which.slice + 1)}${error >= 0 ? `, ${words.figures.errorOf} ${length(error)}` : ''}`;
  }
  if (which.kind === 'part') return of.parts[which.part]?.name ?? '';
  if (which.kind === 'level') {
    const error = desk.errorsBy(of).levels.get(which.level) ?? -1;
    return `${words.figures.level(which.level)}${error >= 0 ? `, ${words.figures.errorOf} ${length(error)}` : ''}`;
  }
  const kind = of.face_kind[which.face];
  if (kind === FaceKind.wall) return words.figures.wallHere;
  if (kind === FaceKind.ground) return words.figures.groundHere;
  if (kind !== FaceKind.panel || (of.face_slice[which.face] as number) < 0) return '';
  const error = of.face_error[which.face] as number;
  return words.figures.here(
    words.figures.slice((of.face_slice[which.face] as number) + 1),
    words.figures.level(of.face_level[which.face] as number),
    Number.isFinite(error) ? length(error) : null,
  );
}

export function sentenceOf(of: Lattice, name: string, psi: number): string {
  const error = of.error_mm && of.error_mm.max > 0 ? length(of.error_mm.max) : null;
  return words.stage.sentence(name || words.bar.unnamed, desk.panelsOf(of), words.psi.text((psi * 180) / Math.PI), error);
}

function nextPin(of: Lattice, face: number | null): desk.Lit | null {
  if (face === null || of.face_kind[face] !== FaceKind.panel) return null;
  const now = desk.pinned.value;
  const part = of.face_part[face];
  if (part !== undefined) return now?.kind === 'part' && now.part === part ? null : { kind: 'part', part };
  const slice = of.face_slice[face] as number;
  const level = of.face_level[face] as number;
  if (now?.kind === 'face' && now.face === face && slice >= 0) return { kind: 'slice', slice };
  if (now?.kind === 'slice' && now.slice === slice && level >= 0) return { kind: 'level', level };
  if (now?.kind === 'level' && now.level === level) return null;
  return { kind: 'face', face };
}

const kColourings: readonly Colouring[] = ['paper', 'error', 'panel', 'k', 'h'];
const kEngine: readonly Colouring[] = ['k', 'h'];   // with the engine's figures only

export function ColourChoice() {
  const of = desk.lattice.value;
  const has = (colouring: Colouring): boolean => {
    if (!of) return colouring === 'paper';
    if (colouring === 'k' || colouring === 'h') {
      const { faces, points } = curvatures(of, colouring);
      return (faces ?? points)?.some(Number.isFinite) ?? false;
    }
    if (colouring === 'error') return of.face_error.some((error) => error > 0);
    return true;
  };
  return (
    <div class="segments" role="radiogroup" aria-label={words.stage.colour}>
      {kColourings.filter((colouring) => desk.engine.value || !kEngine.includes(colouring) || desk.colouring.value === colouring).map((colouring) => (
        <label key={colouring} class={desk.colouring.value === colouring ? 'segment segment-on' : 'segment'}
          title={has(colouring) ? undefined : words.stage.notThere(words.stage[colouring], desk.quality.value === 'draft')}>
          <input type="radio" name="colouring" class="visually-hidden" checked={desk.colouring.value === colouring}
            disabled={!has(colouring) && desk.colouring.value !== colouring} onChange={() => { desk.colouring.value = colouring; }} />
          {words.stage[colouring]}
        </label>
      ))}
    </div>
  );
}

/** Painted in 2D, for browsers without WebGL: drawn again when the slider rests. */
function PaperStage({ why }: { why: string }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout> | undefined;
    const paint = (): void => {
      const of = desk.lattice.peek();
      const lit = of ? desk.litFaces(of, desk.lit.peek()) : null;
      if (canvas.current && of) paintModel(canvas.current, of, desk.psi.peek(), desk.colouring.peek(), lit && new Set(lit));
      if (canvas.current) canvas.current.dataset.drawn = String(Math.round((desk.psi.peek() * 180) / Math.PI));
    };
    const stop = effect(() => {
      void desk.lattice.value;
      void desk.psi.value;
      void desk.colouring.value;
      void desk.lit.value;
      clearTimeout(timer);
      timer = setTimeout(paint, 120);
    });
    const observer = new ResizeObserver(() => { clearTimeout(timer); timer = setTimeout(paint, 120); });
    if (canvas.current) observer.observe(canvas.current);
    return () => { stop(); observer.disconnect(); clearTimeout(timer); };
  }, []);
  const of = desk.lattice.value;
  return (
    <>
      <canvas ref={canvas} class="stage-canvas stage-paper" role="img" aria-label={of ? sentenceOf(of, nameShown(), desk.psi.value) : words.stage.label} />
      <p class="stage-why" role="status">{why}</p>
    </>
  );
}

export function nameShown(): string {
  const spec = desk.spec.value;
  if (desk.foreign.value) return desk.foreign.value.name;
  return spec && typeof spec.name === 'string' ? spec.name : '';
}

let marked: Lattice | null = null;

/** Says to who measures that a new lattice is drawn, and when its input came: `popcut.draft` or `popcut.exact`. */
function markDrawn(): void {
  const of = desk.lattice.peek();
  if (!of || of === marked) return;
  marked = of;
  const name = `popcut.${of.quality}`;
  performance.clearMarks(name);
  performance.mark(name, { detail: desk.shownInput_ms });
}


export function Stage() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const model = useSignal<ModelView | null>(null);
  const state = useSignal<'loading' | 'ready' | 'lost' | 'none'>('loading');

  useEffect(() => {
    let stopped = false;
    const stops: (() => void)[] = [];
    void import('./model_view').then(({ ModelView: View, hasWebgl }) => {
      if (stopped || !canvas.current) return;
      if (!hasWebgl()) {
        state.value = 'none';
        return;
      }
      let view: ModelView;
      try {
        view = new View(canvas.current, {
          onHover: (face) => { desk.hovered.value = face === null ? null : desk.litBy(face); },
          onPick: (face) => {
            const of = desk.lattice.peek();
            if (of) desk.pinned.value = nextPin(of, face);
          },
          onDraw: () => {
            for (const place of placeHandles) place();
            markDrawn();
          },
          onLost: () => { state.value = 'lost'; },
          onRestored: () => { state.value = 'ready'; },
        });
      } catch {
        state.value = 'none';
        return;
      }
      shownModel.view = view;
      model.value = view;
      state.value = 'ready';
      const still = matchMedia('(prefers-reduced-motion: reduce)');
      view.setStill(still.matches);
      const dark = matchMedia('(prefers-color-scheme: dark)');
      const retheme = (): void => view.retheme();
      dark.addEventListener('change', retheme);
      const themes = new MutationObserver(retheme);
      themes.observe(document.documentElement, { attributes: true });
      let shown: Lattice | null = null;
      const pictured = computed(() => {
        const of = desk.lattice.value;
        return of && of.parts.length > 0 && desk.isApart.value ? apart(of) : of;
      });
      stops.push(
        effect(() => {
          const of = pictured.value;
          const moving = desk.moving.value;
          if (of === shown) {
            if (!moving && of) view.fit(false);
            return;
          }
          const first = shown === null;
          shown = of;
          view.setLattice(of, { fit: !moving, blend: !first && desk.quality.peek() === 'exact' });
        }),
        effect(() => view.setBusy(desk.busy.value || desk.moving.value)),
        effect(() => view.setPsi(desk.psi.value)),
        effect(() => view.setColouring(desk.colouring.value)),
        effect(() => view.setGhost(desk.targetShown.value)),
        effect(() => view.setDim(desk.isImpossible.value)),
        effect(() => {
          const which = desk.lit.value;
          const of = pictured.value;
          if (of && of.parts.length > 0) view.markFaces(new Set(desk.litFaces(of, which)));
          view.light(which === null || which.kind === 'part' ? null : which.kind === 'face' ? { face: which.face } : which.kind === 'slice' ? { slice: which.slice } : { level: which.level });
        }),
        () => { dark.removeEventListener('change', retheme); themes.disconnect(); },
      );
    }, () => { state.value = 'none'; });
    return () => {
      stopped = true;
      for (const stop of stops) stop();
      model.value?.dispose();
      shownModel.view = null;
    };
  }, []);

  const onKey = (event: KeyboardEvent): void => {
    const view = model.value;
    if (!view) return;
    const turn: Record<string, [number, number]> = {
      ArrowLeft: [0.12, 0], ArrowRight: [-0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1],
    };
    const by = turn[event.key];
    if (by) view.turn(by[0], by[1]);
    else if (event.key === '+' || event.key === '=') view.zoom(0.85);
    else if (event.key === '-') view.zoom(1 / 0.85);
    else if (event.key === '0') view.fit(true);
    else return;
    event.preventDefault();
  };

  const of = desk.lattice.value;
  const view = model.value;
  const scale = of ? scaleOf(of, desk.colouring.value) : null;
  const paper = state.value === 'none' || state.value === 'lost';
  return (
    <section class="stage" aria-label={words.stage.label}>
      <div class={`stage-frame${paper ? ' stage-behind' : ''}${searching.isFirst.value ? ' stage-is-first' : ''}`}>
        <canvas ref={canvas} class="stage-canvas" role="img" tabIndex={0} onKeyDown={onKey}
          aria-label={of ? sentenceOf(of, nameShown(), desk.psi.value) : words.stage.label} aria-description={words.stage.keys} />
        {view && state.value === 'ready' && <Handles view={view} />}
        {view && state.value === 'ready' && <Worst view={view} />}
        {searching.isFirst.value && <p class="stage-first" role="status">{words.search.draft}</p>}
        {of && of.triangle_face.length === 0
          && <p class="stage-nothing">{mustAnswer(desk.foreign.value?.id) ? words.stage.asked : words.stage.nothing}</p>}
        {paper && <PaperStage why={state.value === 'none' ? words.stage.noWebgl : words.stage.lost} />}
      </div>
      <div class="stage-top">
        <Badge />
        <p class="stage-lit figure" aria-live="polite">{litWords(of, desk.lit.value)}</p>
      </div>
      <div class="stage-foot">
        <ColourChoice />
        {of && of.ghost_triangles.length > 0 && (
          <label class={desk.targetShown.value ? 'segment segment-single segment-on' : 'segment segment-single'}>
            <input type="checkbox" class="visually-hidden" checked={desk.targetShown.value}
              onChange={(event) => { desk.targetShown.value = event.currentTarget.checked; }} />
            {words.stage.target}
          </label>
        )}
        {of && of.parts.length > 0 && (
          <label class={desk.isApart.value ? 'segment segment-single segment-on' : 'segment segment-single'}>
            <input type="checkbox" class="visually-hidden" checked={desk.isApart.value} onChange={(event) => { desk.isApart.value = event.currentTarget.checked; }} />
            {words.stage.apart}
          </label>
        )}
        <button type="button" class="segment segment-single" onClick={() => model.value?.fit(true)}>{words.stage.fit}</button>
        {scale && <Legend scale={scale} />}
        {mergedAny(of) && <p class="legend-what legend-merged">{words.stage.merged}</p>}
      </div>
    </section>
  );
}

/** How true the picture is. */
export function Badge() {
  const { quality } = words;
  const made = desk.quality.value;
  const [text, kind] = desk.isImpossible.value ? [quality.impossible, 'bad'] : made === null ? [quality.working, 'draft']
    : searching.isFirst.value && made === 'exact' ? [quality.first, 'first'] : [quality[made], made === 'exact' ? 'exact' : 'draft'];
  return <span class={`badge badge-${kind}`} role="status">{text}</span>;
}
