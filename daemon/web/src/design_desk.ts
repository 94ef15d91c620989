// SPDX-License-Identifier: MIT
// What is on the desk of the Design view: the spec, its steps, what popcutd made of it, and what is lit.
import { batch, computed, effect, signal } from '@preact/signals';
import { isThere } from './again';
import { optionsOf } from './drawing';
import type { Lattice, Place } from './lattice';
import { FaceKind, LatticeError, readLattice } from './lattice';
import type { Design, Example as Listed } from './model';
import { Previews, type Quality } from './preview';
import { fillFactor } from './outfit';
import type { Colouring } from './ramps';
import { prints } from './preferences';
import { isProblem, newKey, read, readAnswer, request, send, ServerProblem, waitsUntil } from './server';
import { modelOf, nameOf, scaled, Undo, type Spec } from './spec';
import { tabSession } from './tab_store';
import { noteUnsaved } from './unsaved';
import { length } from './words';
import { designWords } from './words_design';

export { unsaved } from './unsaved';

const kUndoKey = 'popcut.design.steps';
const kAgain_ms = [1000, 2000, 5000];

/** One of the examples; without a title until popcutd has listed it. */
export type Example = Omit<Listed, 'title'> & Partial<Pick<Listed, 'title'>>;

/** A pattern of popcutd that is no spec: to look at and to cut. */
export interface Foreign {
  id: string;
  name: string;
  kind: string;
}

export type Lit =
  | { kind: 'face'; face: number }
  | { kind: 'slice'; slice: number }
  | { kind: 'part'; part: number }
  | { kind: 'level'; level: number };

/** Values of a field that were found to be impossible: from there on, to the low or the high side. */
export interface Wall {
  low: number | null;
  high: number | null;
}

export const spec = signal<Spec | null>(null);
export const foreign = signal<Foreign | null>(null);
export const lattice = signal<Lattice | null>(null);
export const quality = signal<Quality | 'stored' | null>(null);
export const busy = signal(false);
export const problem = signal<ServerProblem | null>(null);
export const psi = signal(Math.PI / 2);
export const colouring = signal<Colouring>('paper');
export const targetShown = signal(false);
/** Whether somebody looks at the figures of the engine. */
export const engine = signal(false);
export const hovered = signal<Lit | null>(null);
export const pinned = signal<Lit | null>(null);
export const note = signal<string | null>(null);
export const steps = signal({ undo: false, redo: false });
export const moving = signal(false);
export const walls = signal<ReadonlyMap<string, Wall>>(new Map());
/** The spec that the exact lattice on the desk belongs to. */
export const exactSpec = signal<Spec | null>(null);

export const lit = computed<Lit | null>(() => hovered.value ?? pinned.value);
export const canCut = computed(() => foreign.value !== null
  || (spec.value !== null && quality.value === 'exact' && exactSpec.value === spec.value && problem.value === null));

/** The card was not drawn in the time that a preview may take: it can be tried again. */
export const isLate = computed(() => problem.value?.errors[0]?.code === 'too-long');
/** Parts are drawn away from each other. */
export const isApart = signal(false);
/** What is on the desk cannot be made. */
export const isImpossible = computed(() => problem.value?.status === 422 && !isLate.value);

/** The pointers of the spec's fields that popcutd refused, without the leading /spec. */
export const refused = computed(() => new Map((problem.value?.errors ?? []).map((one) => [
  one.pointer.replace(/^\/spec(?=\/|$)/, ''), one.detail,
])));

const undo = new Undo(tabSession, kUndoKey);
const previewKey = newKey();
/** When each spec came in, by the clock of performance.now(). */
const cameIn = new WeakMap<Spec, number>();
/** When the spec came in that the lattice on the desk belongs to, ms; for who measures. */
export let shownInput_ms = 0;
let lastChange: { field: string; value: number } | null = null;
const good = new Map<string, number>();
let fresh = true;

function tellSteps(): void {
  steps.value = { undo: undo.canUndo, redo: undo.canRedo };
}

export async function preview(of: Spec, how: Quality, signal_: AbortSignal): Promise<Lattice> {
  const answer = await request('POST', '/v1/preview', {
    body: { spec: of, quality: how },
    headers: { 'Preview-Key': previewKey },
    accept: 'application/vnd.popcut.lattice, application/problem+json',
    signal: signal_,
  });
  return readLattice(await answer.arrayBuffer());
}

const previews = new Previews<Spec, Lattice>({
  run: preview,
  onResult: (made, asked) => {
    clearTimeout(missed?.timer);
    missed = null;
    batch(() => {
      const first = fresh;
      fresh = false;
      shownInput_ms = cameIn.get(asked.input) ?? 0;
      lattice.value = made;
      quality.value = asked.quality;
      problem.value = null;
      if (asked.quality === 'exact') exactSpec.value = asked.input;
      if (first) psi.value = made.design_psi_rad;
    });
    if (asked.quality === 'exact' && wish?.of === asked.input) comeNearer(made);
    if (asked.quality === 'exact' && fits?.of === asked.input) comeToFit(made);
    if (lastChange) {
      good.set(lastChange.field, lastChange.value);
      moveWall(lastChange.field, lastChange.value);
    }
  },
  onFailure: (error, asked) => {
    if (isProblem(error) && (error.kind === 'superseded' || error.status === 409)) return;
    if (asked.input !== spec.value) return;
    if (isProblem(error) && passes(error)) {
      askLater(error);
      return;
    }
    const told = isProblem(error) ? error : new ServerProblem(500, { type: 'other', detail: error instanceof Error ? error.message : '' });
    problem.value = told;
    if (isImpossible.value && lastChange) setWall(lastChange.field, lastChange.value);
  },
  onBusy: (now) => { busy.value = now; },
});

/** How large a person wants the exact card to be in one of its measures. */
let wish: { of: Spec; value: number; measure: (of: Lattice) => number; tries: number } | null = null;
const kNearEnough = 0.002;

/**
 * Scales the whole design until `measure` of the exact card is `value`. At another size the steps fall elsewhere, so one
 * scaling may not do.
 */
export function setSize(value: number, measure: (of: Lattice) => number): void {
  const now = spec.peek();
  const have = lattice.peek() ? measure(lattice.peek() as Lattice) : 0;
  if (!now || !(have > 0)) return;
  const next = scaled(now, value / have);
  set(next);
  wish = { of: next, value, measure, tries: 4 };
}

function comeNearer(made: Lattice): void {
  if (!wish) return;
  const { value, measure, tries, of } = wish;
  const have = measure(made);
  wish = null;
  if (!(have > 0) || Math.abs(have - value) <= kNearEnough * value) return;
  const next = tries > 0 ? scaled(of, value / have) : of;
  if (JSON.stringify(next) === JSON.stringify(of)) {
    note.value = designWords.fields.nearestSize(length(have));
    return;
  }
  spec.value = next;
  undo.amend(next);
  wish = { of: next, value, measure, tries: tries - 1 };
  ask(next, true);
}

/** A design that is made smaller until it fits the paper. */
let fits: { of: Spec; tries: number } | null = null;

/** The sheets that a card is cut from: across and along, mm. */
export function sheetsNeeded({ card, parts }: Lattice): [number, number][] {
  return parts.length > 0 ? parts.map(({ box_mm }) => [box_mm[2], box_mm[3]]) : [[card.width_mm, card.wall_mm + card.ground_mm]];
}

/** The factor by which the card is to be made smaller or larger, so that its largest part fills the paper. */
export const factorToFill = (of: Lattice, margin_mm?: number): number =>
  Math.min(...sheetsNeeded(of).map(([width, length]) => fillFactor(width, length, margin_mm)));

/** A change to another card, which is made smaller if it is larger than the paper. */
export function setFitting(next: Spec): void {
  set(next);
  fits = { of: next, tries: 3 };
}

function comeToFit(made: Lattice): void {
  if (!fits) return;
  const { of, tries } = fits;
  fits = null;
  if (tries === 0 || factorToFill(made, 0) >= 1) return;
  const next = scaled(of, factorToFill(made));
  spec.value = next;
  undo.amend(next);
  fits = { of: next, tries: tries - 1 };
  ask(next, true);
}

const kLong_ms = 5000;
/** The exact design takes long: it is still being drawn. */
export const isLong = signal(false);
effect(() => {
  if (!busy.value) {
    isLong.value = false;
    return undefined;
  }
  const timer = setTimeout(() => { isLong.value = true; }, kLong_ms);
  return () => clearTimeout(timer);
});

/** What the desk could not ask for, since when it has tried; null: nothing is missed. */
let missed: { times: number; timer: ReturnType<typeof setTimeout> | undefined } | null = null;

/** True if the same preview may work in a while: popcutd is away, asks to wait, or wants us to sign in. */
function passes(problem_: ServerProblem): boolean {
  return [0, 401, 429].includes(problem_.status);
}

/** A preview changes nothing, so it is asked for again by itself: after a while, or as soon as popcutd is back. */
function askLater(problem_: ServerProblem): void {
  const times = (missed?.times ?? 0) + 1;
  clearTimeout(missed?.timer);
  missed = { times, timer: undefined };
  if (problem_.status === 401) return;
  let wait_ms = kAgain_ms[Math.min(times, kAgain_ms.length) - 1] as number;
  if (problem_.status === 429) {
    wait_ms = Math.min(30, problem_.retryAfter_s || 1) * 1000;
    waitsUntil.value = Date.now() + wait_ms;
  } else {
    problem.value = problem_;
  }
  missed.timer = setTimeout(askAgain, wait_ms);
}

function askAgain(): void {
  if (!missed) return;
  clearTimeout(missed.timer);
  if (spec.value) previews.input(spec.value, true);
}

effect(() => { if (isThere.value) askAgain(); });

/** Asks for what `of` becomes. `settled`: at once for the exact design. */
function ask(of: Spec, settled = false): void {
  clearTimeout(missed?.timer);
  missed = null;
  if (!settled && quality.value === 'exact') quality.value = 'draft';   // what is shown is that of another spec
  previews.input(of, settled);
}

/** Draws the design again that was not drawn in time. */
export function tryAgain(): void {
  problem.value = null;
  if (spec.value) ask(spec.value, true);
}

function setWall(field: string, value: number): void {
  const known = good.get(field);
  if (known === undefined || known === value) return;
  const wall = { ...(walls.value.get(field) ?? { low: null, high: null }) };
  if (value > known) wall.high = wall.high === null ? value : Math.min(wall.high, value);
  else wall.low = wall.low === null ? value : Math.max(wall.low, value);
  walls.value = new Map(walls.value).set(field, wall);
}

/** `value` is possible after all: walls stand beyond it only. */
function moveWall(field: string, value: number): void {
  const wall = walls.value.get(field);
  if (!wall) return;
  const next = { low: wall.low !== null && value <= wall.low ? null : wall.low, high: wall.high !== null && value >= wall.high ? null : wall.high };
  if (next.low !== wall.low || next.high !== wall.high) walls.value = new Map(walls.value).set(field, next);
}

/** A change by a hand that goes on: drafts follow. `field` and `value` name what moves, for its wall. */
export function change(next: Spec, field?: string, value?: number): void {
  if (next === spec.value) return;
  wish = null;
  if (field === undefined || field !== lastChange?.field) walls.value = new Map();
  lastChange = field !== undefined && value !== undefined ? { field, value } : null;
  spec.value = next;
  cameIn.set(next, performance.now());
  ask(next);
}

/** The end of a gesture: one step for undo. */
export function settle(): void {
  moving.value = false;
  if (!spec.value) return;
  undo.push(spec.value);
  noteUnsaved(true);
  tellSteps();
}

/** A change that is whole in itself. */
export function set(next: Spec, field?: string, value?: number): void {
  if (next === spec.value) return;
  change(next, field, value);
  settle();
}

let turn = 0;

/** Begins to open something. The answer says whether it is still wanted: nothing else came onto the desk meanwhile. */
export function opening(): () => boolean {
  const mine = ++turn;
  return () => mine === turn;
}

interface Begin {
  step?: boolean;      // false: it was there before
  made?: boolean;      // by hand, so it is kept nowhere else
  fits?: boolean;      // made smaller if it is larger than the paper
  lattice?: Lattice;   // as it was designed already: then nothing is designed again
}

/** A new design on the desk. */
export function begin(next: Spec, { step = true, made = false, fits: isToFit = false, lattice: known }: Begin = {}): void {
  turn++;
  if (step && modelOf(next) === null) prints.value = 'no';   // what was said of a model is not meant for this
  fresh = true;
  fits = isToFit ? { of: next, tries: 3 } : null;
  good.clear();
  lastChange = null;
  batch(() => {
    foreign.value = null;
    spec.value = next;
    lattice.value = known ?? null;
    quality.value = known ? 'exact' : null;
    exactSpec.value = known ? next : null;
    if (known) psi.value = known.design_psi_rad;
    problem.value = null;
    pinned.value = hovered.value = null;
    note.value = null;
    walls.value = new Map();
  });
  if (step) {
    undo.push(next);
    noteUnsaved(made);
  }
  tellSteps();
  if (known) {
    fresh = false;
    clearTimeout(missed?.timer);
    missed = null;
    previews.drop();
  } else {
    ask(next, true);
  }
}

/** Shows a design whose lattice popcutd keeps at `path`; designs it where that is gone. */
export async function beginKept(next: Spec, path: string): Promise<void> {
  const wanted = opening();
  let known: Lattice | undefined;
  try {
    const answer = await readAnswer(path, { accept: 'application/vnd.popcut.lattice, application/problem+json' });
    known = readLattice(await answer.arrayBuffer());
  } catch (error) {
    if (!isProblem(error) && !(error instanceof LatticeError)) throw error;
  }
  if (wanted()) begin(next, { made: true, lattice: known });
}

function take(next: Spec | null): void {
  if (!next) return;
  lastChange = null;
  batch(() => {
    spec.value = next;
    problem.value = null;
    note.value = null;
  });
  tellSteps();
  ask(next);
}

export const stepBack = (): void => take(undo.undo());
export const stepForward = (): void => take(undo.redo());

/** The design that this tab had before it was reloaded, or null. */
export const kept = (): Spec | null => undo.current;

/** Takes up the design that this tab had. */
export function goOn(): void {
  const last = undo.current;
  if (last) {
    begin(last, { step: false });
    tellSteps();
  }
}

export function leave(): void {
  turn++;
  batch(() => {
    spec.value = null;
    foreign.value = null;
    lattice.value = null;
    quality.value = null;
    problem.value = null;
  });
}

/** The spec is kept somewhere else too: in popcutd, in a file or in a link. */
export function saved(): void {
  noteUnsaved(false);
}

/** Stores a file as a design in popcutd. Throws ServerProblem. */
export async function upload(bytes: BodyInit, type: string, name: string): Promise<Design> {
  const query = name ? `?name=${encodeURIComponent(name.slice(0, 120))}` : '';
  return send<Design>('POST', `/v1/designs${query}`, { raw: { bytes, type } });
}

let stored: { text: string; id: string } | null = null;

/** The id of the design on the desk in popcutd; stores it if it is not there. Throws ServerProblem. */
export async function storedId(): Promise<string> {
  if (foreign.value) return foreign.value.id;
  const of = spec.value;
  const text = JSON.stringify(of, null, 1);
  if (stored?.text === text) return stored.id;
  const design = await upload(text, 'application/json', of ? nameOf(of) : '');
  stored = { text, id: design.id };
  if (spec.value === of) saved();
  return design.id;
}

/**
 * Shows a stored design: a spec on the desk as one's own, any other pattern to look at. Does nothing where it is no
 * longer `wanted` when it comes. Throws ServerProblem, LatticeError.
 */
export async function openStored(id: string, wanted: () => boolean): Promise<void> {
  const design = await read<Design>(`/v1/designs/${encodeURIComponent(id)}`);
  if (design.kind === 'spec') {
    const of = await read<Spec>(`/v1/designs/${encodeURIComponent(id)}/content`);
    if (wanted()) begin(of);
    return;
  }
  const query = Object.entries(optionsOf(id)).map(([name, text]) => `${name}=${encodeURIComponent(text)}`).join('&');
  const answer = await readAnswer(`/v1/designs/${encodeURIComponent(id)}/lattice${query && `?${query}`}`, { accept: 'application/vnd.popcut.lattice' });
  const made = readLattice(await answer.arrayBuffer());
  if (!wanted()) return;
  turn++;
  prints.value = 'no';
  batch(() => {
    spec.value = null;
    foreign.value = { id, name: design.name, kind: design.kind };
    lattice.value = made;
    quality.value = 'stored';
    problem.value = null;
    pinned.value = hovered.value = null;
    psi.value = made.motion === 'flat' ? Math.PI : made.design_psi_rad || Math.PI / 2;
  });
}

/** Shows the drawing on the desk as it is read once `asked` is done, unless another file is opened meanwhile. */
export async function readAgain(asked: Promise<void>): Promise<void> {
  const of = foreign.peek();
  const wanted = opening();
  await asked;
  if (of && wanted()) await openStored(of.id, wanted).catch((error: unknown) => { if (!isProblem(error)) throw error; });
}

/** What a face lights up: itself, or its part. */
export function litBy(face: number): Lit {
  const part = lattice.peek()?.face_part[face];
  return part === undefined ? { kind: 'face', face } : { kind: 'part', part };
}

/** Faces that are lit, or null for none. */
export function litFaces(of: Lattice, which: Lit | null): number[] | null {
  if (!which) return null;
  if (which.kind === 'face') return [which.face];
  const out: number[] = [];
  if (which.kind === 'part') return [...of.face_part.keys()].filter((f) => of.face_part[f] === which.part);
  for (let f = 0; f < of.faces; f++) {
    if (of.face_kind[f] !== FaceKind.panel) continue;
    if (which.kind === 'slice' ? of.face_slice[f] === which.slice : of.face_level[f] === which.level) out.push(f);
  }
  return out;
}

/** What a place of a warning or of the worst error lights up. */
export function litAt(of: Lattice, place: Place | null | undefined): Lit | null {
  if (!place) return null;
  const { slice, level } = place;
  if (slice !== undefined && level !== undefined) {
    for (let f = 0; f < of.faces; f++) {
      if (of.face_kind[f] === FaceKind.panel && of.face_slice[f] === slice && of.face_level[f] === level) return { kind: 'face', face: f };
    }
  }
  if (slice !== undefined) return { kind: 'slice', slice };
  if (level !== undefined) return { kind: 'level', level };
  if (place.u_mm !== undefined && place.v_mm !== undefined) {
    const face = faceAt(of, place.v_mm, place.u_mm);
    if (face !== null) return { kind: 'face', face };
  }
  return null;
}

/** The face at a place of the sheet, v to the right and u down, mm; or null. */
export function faceAt(of: Lattice, v: number, u: number): number | null {
  const wall = of.card.wall_mm;
  const { triangles, points } = of;
  for (let t = 0; t < of.triangle_face.length; t++) {
    let inside = 0;
    for (let k = 0; k < 3; k++) {
      const a = 3 * (triangles[3 * t + k] as number);
      const b = 3 * (triangles[3 * t + ((k + 1) % 3)] as number);
      const au = (points[a] as number) + wall - (points[a + 1] as number);
      const bu = (points[b] as number) + wall - (points[b + 1] as number);
      const av = points[a + 2] as number;
      const bv = points[b + 2] as number;
      inside += (bu - au) * (v - av) - (bv - av) * (u - au) >= 0 ? 1 : -1;
    }
    if (inside === 3 || inside === -3) return of.triangle_face[t] as number;
  }
  return null;
}

/** The largest error of the panels of each slice and each level, mm; -1 where none is measured. */
export function errorsBy(of: Lattice): { slices: Map<number, number>; levels: Map<number, number> } {
  const slices = new Map<number, number>();
  const levels = new Map<number, number>();
  for (let f = 0; f < of.faces; f++) {
    if (of.face_kind[f] !== FaceKind.panel) continue;
    const error = Number.isFinite(of.face_error[f]) ? (of.face_error[f] as number) : -1;
    const s = of.face_slice[f] as number;
    const l = of.face_level[f] as number;
    if (s >= 0) slices.set(s, Math.max(slices.get(s) ?? -1, error));
    if (l >= 0) levels.set(l, Math.max(levels.get(l) ?? -1, error));
  }
  const sorted = (map: Map<number, number>): Map<number, number> => new Map([...map].sort((a, b) => a[0] - b[0]));
  return { slices: sorted(slices), levels: sorted(levels) };
}

/** The panel that is farthest off, or null. */
export function worstFace(of: Lattice): number | null {
  let best: number | null = null;
  let most = 0;
  for (let f = 0; f < of.faces; f++) {
    const error = of.face_error[f] as number;
    if (of.face_kind[f] === FaceKind.panel && error > most) {
      most = error;
      best = f;
    }
  }
  return best;
}

/** How many panels there are. */
export function panelsOf(of: Lattice): number {
  const told = of.report['panels'];
  if (typeof told === 'number') return told;
  let n = 0;
  for (const kind of of.face_kind) if (kind === FaceKind.panel) n++;
  return n;
}
