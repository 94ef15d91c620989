// SPDX-License-Identifier: MIT
// Files that a person gave, sorted out: folders walked, zips unpacked, the models and drawings among them.
import { unzipSync } from 'fflate';
import type { Handed } from './handed';

/** A file, and where it lay in its folder or zip. */
export interface Given {
  path: string;
  file: File;
}

/** What cannot be opened, for whom it is said in words. */
export class GivenTrouble extends Error {
  constructor(readonly kind: 'outside' | 'too-much' | 'too-many' | 'broken-zip', readonly file: string, readonly at = '') {
    super(kind);
  }
}

export const kMostFiles = 1000;
export const kMostUnpacked_mb = 512;
const kMegabyte = 1048576;
const kModels = ['stl', 'obj', 'glb'];
const kDrawings = ['json', 'fold', 'svg', 'dxf', 'pdf', 'ai'];
const kBeside = ['mtl', 'png', 'jpg', 'jpeg', 'webp', 'gif', 'bmp'];

/** An axis of a file with its sign, as searches name it. */
export type Axis = 'x' | 'y' | 'z' | '-x' | '-y' | '-z';

/** The axes that can be in front where `up` is up, the usual one first. */
export const frontsOf = (up: Axis): Axis[] =>
  (up.endsWith('z') ? ['-y', 'y', 'x', '-x'] : up.endsWith('y') ? ['z', '-z', 'x', '-x'] : ['z', '-z', 'y', '-y']);

export const endingOf = (path: string): string => /\.([^./\\]+)$/.exec(path)?.[1]?.toLowerCase() ?? '';
export const nameOf = (path: string): string => path.slice(Math.max(path.lastIndexOf('/'), path.lastIndexOf('\\')) + 1);
const isOutside = (path: string): boolean => /^([/\\]|[A-Za-z]:)/.test(path) || path.split(/[/\\]/).includes('..');

/** Files and folders that were given. Throws GivenTrouble. */
export async function filesOf({ entries, files }: Handed): Promise<Given[]> {
  if (entries.length === 0) return files.map((file) => ({ path: file.name, file }));
  const out: Given[] = [];
  const walk = async (entry: FileSystemEntry): Promise<void> => {
    if (out.length >= kMostFiles) throw new GivenTrouble('too-many', entry.name);
    if (entry.isFile) {
      const file = await new Promise<File>((done, failed) => (entry as FileSystemFileEntry).file(done, failed));
      out.push({ path: entry.fullPath.replace(/^\//, ''), file });
      return;
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) {   // it gives some at a time
      const some = await new Promise<FileSystemEntry[]>((done, failed) => reader.readEntries(done, failed));
      if (some.length === 0) return;
      for (const one of some) await walk(one);
    }
  };
  for (const entry of entries) await walk(entry);
  return out;
}

function unpacked(zip: Given, bytes: Uint8Array): Given[] {
  let size = 0;
  let count = 0;
  const wanted = (one: { name: string; originalSize: number }): boolean => {
    if (isOutside(one.name)) throw new GivenTrouble('outside', zip.path, one.name);
    if (one.name.startsWith('__MACOSX/') || ![...kModels, ...kDrawings, ...kBeside].includes(endingOf(one.name))) return false;
    size += one.originalSize;
    if (size > kMostUnpacked_mb * kMegabyte) throw new GivenTrouble('too-much', zip.path);
    if (++count > kMostFiles) throw new GivenTrouble('too-many', zip.path);
    return true;
  };
  try {
    return Object.entries(unzipSync(bytes, { filter: wanted }))
      .map(([path, content]) => ({ path, file: new File([content as Uint8Array<ArrayBuffer>], nameOf(path)) }));
  } catch (error) {
    if (error instanceof GivenTrouble) throw error;
    throw new GivenTrouble('broken-zip', zip.path);
  }
}

/** The same with what is in zips in place of them. Throws GivenTrouble. */
export async function withZipsOpened(given: readonly Given[]): Promise<Given[]> {
  const out: Given[] = [];
  for (const one of given) {
    if (endingOf(one.path) !== 'zip') out.push(one);
    else if (one.file.size > kMostUnpacked_mb * kMegabyte) throw new GivenTrouble('too-much', one.path);
    else out.push(...unpacked(one, new Uint8Array(await one.file.arrayBuffer())));
  }
  return out;
}

export interface Sorted {
  models: Given[];
  drawings: Given[];   // specs and patterns, too
  beside: Given[];     // what a model may name
}

export function sorted(given: readonly Given[]): Sorted {
  const of = (endings: string[]): Given[] => given.filter((one) => endings.includes(endingOf(one.path)));
  return { models: of(kModels), drawings: of(kDrawings), beside: of(kBeside) };
}

/** The file that a model means by `name`: the path that agrees most, whatever its capitals. */
export function fileFor(name: string, beside: readonly Given[]): Given | null {
  const parts = (path: string): string[] => path.toLowerCase().split(/[/\\]/).reverse();
  const wanted = parts(name);
  let best: Given | null = null;
  let most = 0;
  for (const one of beside) {
    const have = parts(one.path);
    let same = 0;
    while (same < wanted.length && same < have.length && wanted[same] === have[same]) same++;
    if (same > most) [best, most] = [one, same];
  }
  return best;
}

/** Width and height of a PNG or JPEG by its head; null: not known. */
export async function pixelsOf(file: Blob): Promise<[number, number] | null> {
  const head = new DataView(await file.slice(0, 262_144).arrayBuffer());
  if (head.byteLength >= 24 && head.getUint32(0) === 0x89504e47) return [head.getUint32(16), head.getUint32(20)];
  if (head.byteLength < 4 || head.getUint16(0) !== 0xffd8) return null;
  for (let at = 2; at + 9 < head.byteLength;) {
    const marker = head.getUint16(at);
    const isFrame = marker >= 0xffc0 && marker <= 0xffcf && ![0xffc4, 0xffc8, 0xffcc].includes(marker);
    if (isFrame) return [head.getUint16(at + 7), head.getUint16(at + 5)];
    at += 2 + head.getUint16(at + 2);
  }
  return null;
}
