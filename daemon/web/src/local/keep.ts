// SPDX-License-Identifier: MIT
// What this browser keeps: in IndexedDB, each thing under an id that comes from its content. So tabs share it, and none
// of them can overwrite what another one keeps. What the store does not take stays in this tab.
import { storeTrouble } from '../backend';
import type { Bytes } from './frames';

export type Shelf = 'files' | 'designs' | 'plans' | 'searches';
const kShelves: Shelf[] = ['files', 'designs', 'plans', 'searches'];
const kDatabase = 'popcut';
const kVersion = 1;

/** What the store did not take. */
const here = new Map<string, unknown>();
const keyOf = (shelf: Shelf, id: string): string => `${shelf}/${id}`;

let opened: Promise<IDBDatabase | null> | null = null;

function database(): Promise<IDBDatabase | null> {
  opened ??= new Promise((done) => {
    const refused = (): void => {
      storeTrouble.value ??= 'forbidden';
      done(null);
    };
    try {
      const request = indexedDB.open(kDatabase, kVersion);
      request.onupgradeneeded = () => { for (const shelf of kShelves) request.result.createObjectStore(shelf); };
      request.onsuccess = () => {
        const base = request.result;
        base.onversionchange = () => { base.close(); opened = null; };   // a newer page in another tab
        done(base);
      };
      request.onerror = refused;
      request.onblocked = refused;
    } catch {
      refused();
    }
  });
  return opened;
}

/** Waits for what `act` asks of a shelf. Null: there is no store. Throws DOMException. */
async function ask<T>(shelf: Shelf, mode: IDBTransactionMode, act: (of: IDBObjectStore) => IDBRequest<T>): Promise<{ value: T } | null> {
  const base = await database();
  if (!base) return null;
  return new Promise((done, failed) => {
    const transaction = base.transaction(shelf, mode);
    const request = act(transaction.objectStore(shelf));
    transaction.oncomplete = () => done({ value: request.result });
    transaction.onabort = transaction.onerror = () => failed(transaction.error ?? request.error);
  });
}

/** Keeps a thing. Never fails: what the store does not take, this tab holds. */
export async function put(shelf: Shelf, id: string, value: unknown): Promise<void> {
  try {
    if (await ask(shelf, 'readwrite', (of) => of.put(value, id))) {
      here.delete(keyOf(shelf, id));
      return;
    }
  } catch {
    storeTrouble.value = 'full';
  }
  here.set(keyOf(shelf, id), value);
}

export async function get<T>(shelf: Shelf, id: string): Promise<T | undefined> {
  const held = here.get(keyOf(shelf, id));
  if (held !== undefined) return held as T;
  return (await ask(shelf, 'readonly', (of) => of.get(id)).catch(() => null))?.value as T | undefined;
}

/** All ids of a shelf. */
export async function idsOf(shelf: Shelf): Promise<string[]> {
  const ids = new Set((await ask(shelf, 'readonly', (of) => of.getAllKeys()).catch(() => null))?.value as string[] | undefined);
  for (const key of here.keys()) if (key.startsWith(`${shelf}/`)) ids.add(key.slice(shelf.length + 1));
  return [...ids];
}

export async function remove(shelf: Shelf, id: string): Promise<void> {
  here.delete(keyOf(shelf, id));
  await ask(shelf, 'readwrite', (of) => of.delete(id)).catch(() => undefined);
}

/** Forgets everything. */
export async function clear(): Promise<void> {
  here.clear();
  for (const shelf of kShelves) await ask(shelf, 'readwrite', (of) => of.clear()).catch(() => undefined);
  storeTrouble.value = null;
}

export async function sha256(bytes: Bytes): Promise<string> {
  const digest = new Uint8Array(await crypto.subtle.digest('SHA-256', bytes));
  return [...digest].map((byte) => byte.toString(16).padStart(2, '0')).join('');
}

export interface KeptFile { name: string; type: string; bytes: Bytes }
export interface KeptDesign { id: string; name: string; kind: string; bytes: number; created: string; assets: string[] }

/** Keeps bytes under the id of their content. */
export async function putFile(bytes: Bytes, name: string, type: string): Promise<string> {
  const id = `sha256-${await sha256(bytes)}`;
  await put('files', id, { name, type, bytes } satisfies KeptFile);
  return id;
}

const kMark = 'popcut-kept.json';

/** Designs and the files that they need, as one file. Plans and searches are made again from these. */
export async function exported(): Promise<Blob> {
  const { zip } = await import('fflate');
  const designs: KeptDesign[] = [];
  const files: Record<string, [Bytes, { level: 0 | 6 }]> = {};
  const names: Record<string, { name: string; type: string }> = {};
  for (const id of await idsOf('designs')) {
    const design = await get<KeptDesign>('designs', id);
    if (design) designs.push(design);
  }
  for (const id of await idsOf('files')) {
    const file = await get<KeptFile>('files', id);
    if (!file) continue;
    files[`files/${id}`] = [file.bytes, { level: 6 }];
    names[id] = { name: file.name, type: file.type };
  }
  const mark = new TextEncoder().encode(JSON.stringify({ popcut: 1, designs, files: names }));
  return new Promise((done, failed) => {
    zip({ [kMark]: mark, ...files }, (error, bytes) => (error ? failed(error) : done(new Blob([bytes], { type: 'application/zip' }))));
  });
}

const kMostImported = 1 << 30;

/** Takes what `exported` made, beside what is here. Returns the number of designs; null: this is no such file. */
export async function imported(file: Blob): Promise<number | null> {
  const { unzip } = await import('fflate');
  let left = kMostImported;
  const parts = await new Promise<Record<string, Uint8Array> | null>((done) => {
    const take = (bytes: Uint8Array): unknown => unzip(bytes, {
      filter: ({ name, originalSize }) => (left -= originalSize) > 0 && (name === kMark || /^files\/sha256-[0-9a-f]{64}$/.test(name)),
    }, (error, found) => done(error ? null : found));
    file.arrayBuffer().then((bytes) => take(new Uint8Array(bytes)), () => done(null));
  });
  const mark = parts?.[kMark];
  if (!parts || !mark) return null;
  let about: { popcut?: unknown; designs?: unknown; files?: unknown };
  try {
    about = JSON.parse(new TextDecoder().decode(mark)) as typeof about;
  } catch {
    return null;
  }
  if (about.popcut !== 1 || !Array.isArray(about.designs) || typeof about.files !== 'object' || about.files === null) return null;
  const names = about.files as Record<string, { name?: unknown; type?: unknown }>;
  const there = new Set(await idsOf('files'));
  for (const [path, bytes] of Object.entries(parts)) {
    const id = path.slice('files/'.length);
    if (path === kMark || there.has(id)) continue;
    const copy = new Uint8Array(bytes);
    if (`sha256-${await sha256(copy)}` !== id) continue;   // it was changed on its way
    await put('files', id, { name: String(names[id]?.name ?? ''), type: String(names[id]?.type ?? ''), bytes: copy } satisfies KeptFile);
    there.add(id);
  }
  let count = 0;
  for (const one of about.designs as Partial<KeptDesign>[]) {
    if (typeof one?.id !== 'string' || !there.has(one.id)) continue;
    await put('designs', one.id, {
      id: one.id, name: String(one.name ?? ''), kind: String(one.kind ?? 'spec'), bytes: Number(one.bytes) || 0, created: String(one.created ?? ''),
      assets: Array.isArray(one.assets) ? one.assets.map(String) : [],
    } satisfies KeptDesign);
    count++;
  }
  return count;
}
