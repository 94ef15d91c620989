// SPDX-License-Identifier: MIT
// How a file comes onto the desk: what it is, which of several is meant, and how a model is to stand.
import { signal } from '@preact/signals';
import * as desk from './design_desk';
import { endingOf, frontsOf, GivenTrouble, kMostFiles, kMostUnpacked_mb, sorted, withZipsOpened, type Axis, type Given } from './model_files';
import type { Read } from './model_scene';
import { prints } from './preferences';
import { isProblem, send, type ServerProblem } from './server';
import * as searching from './search_desk';
import { isSpec, modelOf, parseSpec, SpecError, type Spec } from './spec';
import { LatticeError } from './lattice';
import { can, may, meta } from './store';
import { designWords as words } from './words_design';

/** What came of opening something, in words. `chooses`: another file may help. */
export interface Sentence {
  text: string;
  chooses?: boolean;
}
export type Said = Sentence | ServerProblem | null;

/** How a model is to stand: a person is asked with its pictures. */
export interface Question {
  given: Given;
  beside: Given[];
  read: Read;
  up: Axis;
  guess: Axis | null;
  pictures: ReadonlyMap<string, string>;   // by `pictureKey`; none where the browser cannot draw
}

export const question = signal<Question | null>(null);
/** Of several models or drawings that were given together, one is meant. */
export const several = signal<{ of: Given[]; title: string; open: (one: Given) => Promise<Said> } | null>(null);
/** What goes on, in words. */
export const doing = signal<string | null>(null);

export const pictureKey = (up: Axis, front: Axis): string => `${up} ${front}`;
export const kUps: Axis[] = ['y', 'z', 'x', '-y', '-z', '-x'];
const kPicture_px = 320;
const kNamedFiles = 120;

const kPatterns: Record<string, string> = {
  fold: 'application/json', svg: 'image/svg+xml', dxf: 'image/vnd.dxf', pdf: 'application/pdf', ai: 'application/pdf',
};
const kModels: Record<string, string> = { stl: 'model/stl', obj: 'model/obj', glb: 'model/gltf-binary' };
const kPictures = ['png', 'jpg', 'jpeg', 'webp', 'gif', 'bmp'];

const stem = (name: string): string => name.replace(/\.[^.]*$/, '').slice(0, kNamedFiles);

export function said(error: unknown): Said {
  if (isProblem(error)) return error;
  if (error instanceof SpecError) return { text: words.linkErrors[error.message] ?? error.message };
  if (error instanceof LatticeError) return { text: error.message };
  if (!(error instanceof GivenTrouble)) throw error;
  const { open } = words;
  const text = {
    outside: open.zipOutside(error.file, error.at), 'broken-zip': open.zipBroken(error.file),
    'too-much': open.zipTooMuch(error.file, kMostUnpacked_mb), 'too-many': open.tooMany(error.file, kMostFiles),
  }[error.kind];
  return { text, chooses: true };
}

const limitsNow = (): Record<string, number> | undefined => meta.value?.limits as Record<string, number> | undefined;

function tooLarge(file: File): Said {
  const limits = limitsNow();
  const most = kModels[endingOf(file.name)] ? limits?.asset_bytes : limits?.design_bytes;
  return most !== undefined && file.size > most ? { text: words.open.tooLarge(file.name, `${Math.round(most / 1048576)} MiB`), chooses: true } : null;
}

/** Opens what a person gave: files, folders and zips. */
export async function open(from: () => Promise<Given[]> | Given[]): Promise<Said> {
  const wanted = desk.opening();
  try {
    const given = await withZipsOpened(await from());
    const { models, drawings, beside } = sorted(given);
    if (!wanted() || given.length === 0) return null;
    const { several: title } = words.standing;
    if (models.length > 1) {
      several.value = { of: models, title: title(models.length), open: (one) => openModel(one, beside) };
      return null;
    }
    if (models.length === 0 && drawings.length > 1) {
      several.value = { of: drawings, title: title(drawings.length, true), open: openOneDrawing };
      return null;
    }
    const [model] = models;
    if (model) return await openModel(model, beside);
    const [drawing] = drawings;
    if (drawing) return await openDrawing(drawing, wanted);
    const [first] = given;
    if (given.length > 1) return { text: words.open.noneOf(given.length), chooses: true };
    const isPicture = kPictures.includes(endingOf(first!.path));
    return { text: isPicture ? words.open.picture(first!.file.name) : words.open.unknown(first!.file.name), chooses: true };
  } catch (error) {
    return wanted() ? said(error) : null;
  } finally {
    doing.value = null;
  }
}

async function openOneDrawing(one: Given): Promise<Said> {
  several.value = null;
  const wanted = desk.opening();
  try {
    return await openDrawing(one, wanted);
  } catch (error) {
    return wanted() ? said(error) : null;
  } finally {
    doing.value = null;
  }
}

async function openDrawing({ file, path }: Given, wanted: () => boolean): Promise<Said> {
  const large = tooLarge(file);
  if (large) return large;
  const ending = endingOf(path);
  if (kPatterns[ending] === 'application/pdf' && !can('queue')) return { text: words.open.pdf(file.name), chooses: true };
  if (ending === 'json') {
    const text = await file.text();
    const value: unknown = (() => { try { return JSON.parse(text); } catch { return null; } })();
    if (isSpec(value)) {
      if (wanted()) desk.begin(value);
      return null;
    }
    if (typeof value !== 'object' || value === null || !('vertices_coords' in value)) {
      parseSpec(text);
      return null;
    }
  }
  doing.value = words.open.uploading;
  const design = await desk.upload(file, kPatterns[ending] ?? 'application/json', stem(file.name));
  await desk.openStored(design.id, wanted);
  return null;
}

/** The model that was asked about last. */
let printed: { name: string; coloured: boolean } | null = null;

/** Reads a model and asks how it is to stand; what cannot be read goes to popcutd, which says why. */
export async function openModel(given: Given, beside: readonly Given[]): Promise<Said> {
  several.value = null;
  const large = tooLarge(given.file);
  if (large) return large;
  const wanted = desk.opening();
  try {
    doing.value = words.open.looking;
    const scenes = may('submitter') ? await import('./model_scene') : null;
    const read = await scenes?.readModel(given, beside) ?? null;
    if (!wanted()) return null;
    const [has, most] = [scenes !== null && read !== null ? scenes.trianglesOf(read) : 0, limitsNow()?.triangles];
    if (most !== undefined && has > most) return { text: words.open.tooManyTriangles(given.file.name, has, most), chooses: true };
    if (scenes === null || read === null) return await place(given.file, given.file.name, kModels[endingOf(given.path)] as string, null, wanted);
    const pictures = new Map<string, string>();
    let guess: Axis | null = null;
    try {
      const sides = new scenes.Sides(read.scene, kPicture_px);
      try {
        guess = sides.guess(read.up);
        for (const front of frontsOf(read.up)) pictures.set(pictureKey(read.up, front), await sides.picture(read.up, front));
        for (const up of kUps) {
          const front = frontsOf(up)[0] as Axis;
          if (up !== read.up) pictures.set(pictureKey(up, front), await sides.picture(up, front));
        }
      } finally {
        sides.dispose();
      }
    } catch {
      // without WebGL the sides have names
    }
    if (!wanted()) return null;
    // Its colours are to be seen; what was said of another model is not meant for this one.
    const before = printed;
    printed = { name: given.path, coloured: read.coloured };
    if (before?.name !== given.path || before.coloured !== read.coloured) prints.value = read.coloured ? 'yes' : 'no';
    ask({ given, beside: [...beside], read, up: read.up, guess, pictures });
    return null;
  } catch (error) {
    return wanted() ? said(error) : null;
  } finally {
    doing.value = null;
  }
}

/** The model that was opened last, to be turned again. */
const last = signal<{ question: Question; asset: string } | null>(null);
export const canTurn = (asset: string): boolean => last.value?.asset === asset;
export function turn(): void {
  const of = last.peek();
  if (of) void openModel(of.question.given, of.question.beside).then(() => undefined);
}

function ask(next: Question | null): void {
  const before = question.peek();
  question.value = next;
  for (const [key, address] of before?.pictures ?? []) if (next?.pictures.get(key) !== address) URL.revokeObjectURL(address);
}

export function forget(): void {
  ask(null);
}

/** The model stands on another side: draws the four fronts that it then may have. */
export async function standOn(up: Axis): Promise<void> {
  const before = question.peek();
  if (!before) return;
  const of = { ...before, up, guess: null };
  question.value = of;
  const scenes = await import('./model_scene');
  const pictures = new Map(of.pictures);
  let guess: Axis | null = null;
  try {
    const sides = new scenes.Sides(of.read.scene, kPicture_px);
    guess = sides.guess(up);
    for (const front of frontsOf(up)) {
      const key = pictureKey(up, front);
      if (!pictures.has(key)) pictures.set(key, await sides.picture(up, front));
    }
    sides.dispose();
  } catch {
    // as above
  }
  if (question.peek() === of) question.value = { ...of, guess, pictures };
}

/** Files that were missing. */
export async function add(more: Given[]): Promise<Said> {
  const of = question.peek();
  if (!of) return null;
  try {
    const { beside } = sorted(await withZipsOpened(more));
    return await openModel(of.given, [...of.beside.filter((one) => !beside.some((each) => each.path === one.path)), ...beside]);
  } catch (error) {
    return said(error);
  }
}

/** Begins with the model as it is to stand; `front` null: popcut chooses. `clay`: without its colours. */
export async function answer(front: Axis | null, clay: boolean): Promise<Said> {
  const of = question.peek();
  if (!of) return null;
  const wanted = desk.opening();
  try {
    doing.value = words.open.placing;
    const { packed } = await import('./model_scene');
    const file = await packed(of.read, of.given, clay);
    if (!wanted()) return null;
    ask(null);
    const large = tooLarge(new File([file.bytes], file.name));
    const what = large ?? await place(file.bytes, file.name, file.type, { up: of.up, front: front ?? 'any' }, wanted);
    const asset = modelOf(desk.spec.peek());
    if (what === null && asset !== null && desk.spec.peek() === searching.draft.peek()) last.value = { question: of, asset };
    return what;
  } catch (error) {
    return wanted() ? said(error) : null;
  } finally {
    doing.value = null;
  }
}

interface Stand {
  up: string;
  front: string;
}

/** A spec of the model that is placed in the corner. Throws ServerProblem. */
async function placedSpec(bytes: Blob, name: string, type: string, stand: Stand | null): Promise<Spec> {
  const asset = await send<{ id: string }>('POST', `/v1/assets?name=${encodeURIComponent(name.slice(0, kNamedFiles))}`, { raw: { bytes, type } });
  const first: Spec = {
    popcut: 1, name: stem(name), surface: { type: 'mesh', file: asset.id }, fit: 'nearest',
    units_per_slice: 6, slices: 10, widths_mm: 10, min_panel_mm: 2,
  };
  const placed = async (how: Stand | null): Promise<Spec> =>
    (await send<{ spec: Spec }>('POST', '/v1/place', { body: { spec: first, place: 'whole', ...how } })).spec;
  try {
    // Where this way of standing makes no lattice, another one shows at least something until cards are found.
    return await placed(stand).catch((error: unknown) => {
      if (stand && isProblem(error) && error.status === 422) return placed(null);
      throw error;
    });
  } catch (error) {
    throw isProblem(error) ? error.naming(asset.id, name) : error;
  }
}

async function place(bytes: Blob, name: string, type: string, stand: Stand | null, wanted: () => boolean): Promise<Said> {
  doing.value = words.open.placing;
  const placed = await placedSpec(bytes, name, type, stand);
  if (!wanted()) return null;
  desk.begin(placed);
  const model = modelOf(placed);
  if (model === null || !may('submitter')) return null;
  searching.draft.value = placed;
  searching.asked.value = { ...searching.asked.peek(), ...(stand ?? { up: 'usual', front: 'any' }) };
  void searching.begin(model);
  return null;
}
