// SPDX-License-Identifier: MIT
// The search for the best cards of the model on the desk: what is asked for, how far it is, what it found.
import { computed, signal } from '@preact/signals';
import * as desk from './design_desk';
import type { Search } from './model';
import { searchWishes } from './outfit';
import { isProblem, read, send, type ServerProblem } from './server';
import type { Spec } from './spec';

/** What a person asks for. */
export interface Asked {
  max_minutes: number;
  cards: number;   // of a book around one spine; 1: a card alone
  up: string;
  front: string;   // of a card alone
  effort: number;
  label: string;   // how hard to fold, at most
}

export const kQuick = 0.1;
export const kThorough = 1;
export const kCards = [1, 3, 4, 5, 6, 8, 12];
const kLook_ms = [300, 500, 1000];

export const asked = signal<Asked>({ max_minutes: 15, cards: 1, up: 'usual', front: 'any', effort: kQuick, label: 'any' });
/** What was made of a model to begin with, until cards are found. */
export const draft = signal<Spec | null>(null);
/** The asset that is or was searched last. */
export const model = signal<string | null>(null);
export const search = signal<Search | null>(null);
export const problem = signal<ServerProblem | null>(null);
export const busy = signal(false);   // from the press until the search ends
/** What is on the desk only holds the place of cards that are searched still. */
export const isFirst = computed(() => busy.value && draft.value !== null && draft.value === desk.spec.value);

let turn = 0;

/** Requests that begin and remove searches, one after the other: the same search is one at popcutd, however often it is begun. */
let line: Promise<unknown> = Promise.resolve();
function inLine<T>(what: () => Promise<T>): Promise<T> {
  const mine = line.then(what);
  line = mine.catch(() => undefined);
  return mine;
}

const pause = (ms: number): Promise<void> => new Promise((done) => setTimeout(done, ms));

async function follow(id: string, mine: number): Promise<void> {
  for (let looks = 0; mine === turn; looks++) {
    const now = await read<Search>(`/v1/searches/${encodeURIComponent(id)}`);
    if (mine !== turn) return;
    search.value = now;
    if (now.state !== 'pending') return;
    await pause(kLook_ms[Math.min(looks, kLook_ms.length - 1)] as number);
  }
}

/** Searches the cards of a model, until they are found or something else is searched. The same search is made once. */
export async function begin(of: string, material?: unknown): Promise<void> {
  const mine = ++turn;
  const before = search.peek();
  if (busy.peek() && before?.state === 'pending') forget(before.id);
  model.value = of;
  search.value = null;
  problem.value = null;
  busy.value = true;
  try {
    const { front, ...wishes } = asked.peek();
    const body = { ...wishes, ...searchWishes(), ...(wishes.cards === 1 ? { front } : {}), ...(typeof material === 'string' && material !== '' ? { material } : {}) };
    const begun = await inLine(async () => {
      if (mine !== turn) return null;
      const made = await send<Search>('POST', `/v1/assets/${encodeURIComponent(of)}/search`, { body });
      if (mine === turn) return made;
      if (made.state === 'pending') await remove(made.id);   // cancelled while popcutd began it
      return null;
    });
    if (begun === null || mine !== turn) return;
    search.value = begun;
    await follow(begun.id, mine);
  } catch (error) {
    if (!isProblem(error)) throw error;
    if (mine === turn) problem.value = error;
  } finally {
    if (mine === turn) busy.value = false;
  }
}

/** What popcutd still searches is not wanted any more; if it is somebody else's too, it goes on for them. */
function forget(id: string): void {
  void inLine(() => remove(id));
}

async function remove(id: string): Promise<void> {
  await send('DELETE', `/v1/searches/${encodeURIComponent(id)}`).catch(() => undefined);
}

export function cancel(): void {
  const of = search.peek();
  turn++;
  busy.value = false;
  search.value = null;
  if (of?.state === 'pending') forget(of.id);
}
