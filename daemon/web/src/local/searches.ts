// SPDX-License-Identifier: MIT
// Searches of cards in this browser: one at a time. A search that was ended leaves nothing; one that has found is kept.
import type { Search } from '../model';
import { perform, Refusal, refusal, rowsOf } from './answers';
import { Lane } from './engine';
import type { Bytes, Task } from './frames';
import { get, put, remove, sha256, type KeptFile } from './keep';

interface Kept { body: Search; files: Map<string, Bytes> }

/** Of this computer; browsers that do not tell have that much mostly. */
export const memory_GB = (navigator as Navigator & { deviceMemory?: number }).deviceMemory ?? 4;
const kWorkers = Math.max(1, Math.min(8, navigator.hardwareConcurrency || 1, memory_GB / 0.5));
/** What a worker takes for each byte of its model. */
const kHeld = 20;
/** How often a worker comes back for more of one step. */
const kTurns = 3;
const lanes = Array.from({ length: Math.floor(kWorkers) }, () => new Lane());
const running = new Map<string, { body: Search; stop: AbortController }>();
const plain = new TextDecoder();
const cardFile = (number: string | number, ending: string): string => `card-${String(number).padStart(2, '0')}.${ending}`;

const kUsual = {
  max_minutes: 15, mat: '', style: 'any', up: 'usual', front: 'any', cards: 1, marks: false, max_folds: 0, min_fold_mm: 0, label: 'any', plain: false,
  effort: 1, seed: 1,
};

/** The axis that points up in a file of this name, as core/search/standing.hpp has it. */
function upOf(up: string, name: string, front: string): string {
  if (up !== 'usual') return up;
  const ending = name.slice(name.lastIndexOf('.')).toLowerCase();
  const usual = ['.obj', '.glb', '.gltf'].includes(ending) ? 'y' : ending === '.stl' ? 'z' : 'any';
  return front === usual || front === `-${usual}` ? 'any' : usual;
}

function nameOf(file: string): string {
  const name = file.slice(Math.max(file.lastIndexOf('/'), file.lastIndexOf('\\')) + 1).replace(/(.)\.[^.]*$/, '$1');
  return name !== '' && name.length <= 60 && !/\p{Cc}/u.test(name) ? name : 'model';
}

/** Begins a search of the cards of a model; the same search is one. Throws Refusal. */
export async function beginSearch(model: string, body: Record<string, unknown>): Promise<Search> {
  const file = await get<KeptFile>('files', model);
  if (!file) throw refusal(404, 'not-found', 'this model is not kept in this browser');
  const asked = { ...kUsual, ...body } as typeof kUsual & { machine?: string; material?: string };
  const up = upOf(asked.up, file.name, asked.front);
  const machine = asked.machine ?? 'cameo3';
  const material = asked.material ?? 'paper-220';
  const rows = await rowsOf(machine, material);
  const words: Record<string, unknown> = {
    model, name: nameOf(file.name), mat: asked.mat, style: asked.style, up, front: asked.front, cards: asked.cards, marks: asked.marks, seed: asked.seed,
    max_minutes: asked.max_minutes, effort: asked.effort,
  };
  if (asked.max_folds > 0) words.max_folds = asked.max_folds;
  if (asked.min_fold_mm > 0) words.min_fold_mm = asked.min_fold_mm;
  if (asked.label !== 'any') words.label = asked.label;
  if (asked.plain) words.plain = true;
  const id = (await sha256(new TextEncoder().encode(JSON.stringify([words, rows])))).slice(0, 32);
  const before = running.get(id)?.body ?? (await get<Kept>('searches', id))?.body;
  if (before && before.state !== 'failed') return { ...before };
  const search: Search = {
    id, model, name: nameOf(file.name), owner: null, state: 'pending', machine, material, mat: asked.mat || null, max_minutes: asked.max_minutes,
    style: asked.style, up, front: asked.front, marks: asked.marks, book: asked.cards > 1 ? { cards: asked.cards } : null,
    max_folds: asked.max_folds || null, min_fold_mm: asked.min_fold_mm, label: asked.label, plain: asked.plain, effort: asked.effort, seed: asked.seed,
    progress: null, cards: [], recommended: null, better_front: null, tried: null, notes: [], error: null, created: new Date().toISOString(),
    links: { self: `/v1/searches/${id}` },
  };
  const stop = new AbortController();
  running.set(id, { body: search, stop });
  void run(search, file.bytes, { ...rows, words: JSON.stringify(words) }, stop.signal);
  return { ...search };
}

interface Front {
  cards: ({ spec: string; page_mm?: number } & Record<string, unknown>)[];
  designed: number; planned: number; verified: number; seen_share: number; mat_mm: [number, number];
  notes: string[]; recommended: number; better_front?: string;
}

type How = Pick<Task, 'design' | 'machine' | 'material' | 'options'>;
interface Wanted { ways: unknown; rough: boolean; doing: string; part: [number, number]; candidates: unknown[]; finals: unknown[]; drawn: boolean }
const utf8 = new TextEncoder();
const named = (name: string, content: unknown): ReadonlyMap<string, Bytes> => new Map([[name, utf8.encode(JSON.stringify(content))]]);

/**
 * A search in steps (daemon/planning/search/search_steps.hpp): one worker says which candidates are to be judged or which
 * cards to be finished, all of them take some, and it goes on. What is found does not depend on how many there are.
 */
async function searched(how: How, signal: AbortSignal, tell: (doing: string, share: number | null) => void): Promise<Map<string, Bytes>> {
  const phase = (text: string): { doing: string; done: number } => JSON.parse(text) as { doing: string; done: number };
  const shown = (text: string): void => {
    const { doing, done } = phase(text);
    tell(doing, done >= 0 ? done : null);
  };
  // As many as there is room for in half of the memory: each holds the model and its designs.
  const room = Math.floor((memory_GB * (512 << 20)) / (kHeld * how.design.length));
  const working = lanes.slice(0, Math.max(1, room));
  const first = lanes[0]!;
  if (working.length === 1) return (await perform(first, { kind: 'search', ...how }, signal, shown)).files;
  const memory: { ways: unknown } & Record<'cards' | 'finished' | 'drawn', unknown[]> = { ways: null, cards: [], finished: [], drawn: [] };
  const pictures = new Map<string, Bytes>();   // and lattices, of what is drawn
  for (;;) {
    const assets = new Map([...named('memory.json', memory), ...pictures]);
    const { files } = await perform(first, { kind: 'search', ...how, assets }, signal, shown);
    const text = files.get('wanted.json');
    if (!text) return files;
    const { candidates, finals, part: [from, to], doing, ...of } = JSON.parse(plain.decode(text)) as Wanted;
    memory.ways = of.ways;
    const ends = finals.length > 0;
    const all = ends ? finals : candidates;
    // Some take longer than others, so nobody takes too many at once.
    const each = Math.ceil(all.length / (kTurns * working.length));
    const judged: unknown[][] = [];
    const finished: unknown[][] = [];
    let next = 0;
    const done = new Map<number, number>();
    const told = (): void => tell(doing, from + ((to - from) * [...done.values()].reduce((sum, one) => sum + one, 0)) / all.length);
    await Promise.all(working.map(async (lane) => {
      while (next * each < all.length) {
        const k = next++;
        const some = all.slice(k * each, (k + 1) * each);
        const asked = named('judge.json', { ...of, doing, part: [from, to], candidates: ends ? [] : some, finals: ends ? some : [] });
        const made = await perform(lane, { kind: 'search', ...how, assets: asked }, signal, (said) => {
          done.set(k, some.length * Math.max(0, phase(said).done));
          told();
        });
        const listed = (file: string): unknown[] => (made.files.has(file) ? JSON.parse(plain.decode(made.files.get(file))) as unknown[] : []);
        judged[k] = listed('judged.json');
        finished[k] = listed('finished.json');
        for (const [name, bytes] of made.files) {
          const [, number, ending] = /^card-(\d+)\.(\w+)$/.exec(name) ?? [];
          if (number) pictures.set(cardFile(k * each + Number(number), ending!), bytes);
        }
        done.set(k, some.length);
        told();
      }
    }));
    memory.cards.push(...judged.flat());
    memory[of.drawn ? 'drawn' : 'finished'].push(...finished.flat());
  }
}

async function run(search: Search, design: Bytes, how: { machine: string; material: string; words: string }, signal: AbortSignal): Promise<void> {
  try {
    const task = { design, machine: how.machine, material: how.material, options: { search: how.words } };
    const files = await searched(task, signal, (doing, share) => { search.progress = { doing, share }; });
    const front = JSON.parse(plain.decode(files.get('front.json'))) as Front;
    search.cards = front.cards.map(({ spec, ...card }, k) => {
      const own = `${search.links.self}/cards/${k + 1}`;
      return { page_mm: null, tabs: 0, ...card, card: k + 1, spec: JSON.parse(spec) as unknown, links: { picture: `${own}.png`, lattice: `${own}/lattice`, design: `${own}/design` } } as unknown as Search['cards'][number];
    });
    search.recommended = front.recommended || null;
    search.better_front = front.better_front ?? null;
    search.tried = { designed: front.designed, planned: front.planned, verified: front.verified, mat_mm: front.mat_mm, seen_share: front.seen_share };
    search.notes = front.notes;
    search.state = 'found';
    search.progress = null;
    await put('searches', search.id, { body: search, files } satisfies Kept);
    running.delete(search.id);
  } catch (error) {
    if (signal.aborted) return;
    search.state = 'failed';
    search.progress = null;
    search.error = error instanceof Refusal ? error.message : String(error);
  }
}

/** Throws Refusal. */
export async function findSearch(id: string): Promise<Search> {
  const body = running.get(id)?.body ?? (await get<Kept>('searches', id))?.body;
  if (!body) throw refusal(404, 'not-found', 'this search is not kept in this browser');
  return body;
}

export async function endSearch(id: string): Promise<void> {
  running.get(id)?.stop.abort();
  running.delete(id);
  await remove('searches', id);
}

/** A picture or lattice of a card that was found. Throws Refusal. */
export async function readyCard(id: string, card: string, ending: string): Promise<Bytes> {
  const bytes = (await get<Kept>('searches', id))?.files.get(cardFile(card, ending));
  if (!bytes) throw refusal(404, 'not-found', 'this card is not kept in this browser');
  return bytes;
}
