// SPDX-License-Identifier: MIT
// A Web Worker with an instance of the engine: does one task after another.
import popcutEngine from 'engine';
import type { Frame } from './frames';

/** What comes to a worker: the compiled engine first, then tasks, each the bytes of its frames. */
export type ToWorker = { module: WebAssembly.Module } | { task: Uint8Array };
/** What comes from it. `bytes` is the memory that it holds then. */
export type FromWorker = { frame: Frame } | { done: true; bytes: number } | { broken: string };

interface Engine {
  onFrame: (kind: number, name: string, bytes: Frame['bytes']) => void;
  HEAPU8: Uint8Array;
  _malloc(size: number): number;
  _free(at: number): void;
  _popcut_answer(at: number, size: number): void;
}

const tell = (what: FromWorker, transfer: Transferable[] = []): void => (self as unknown as Worker).postMessage(what, transfer);
let engine: Promise<Engine> | null = null;

function start(module: WebAssembly.Module): Promise<Engine> {
  return popcutEngine({
    instantiateWasm: (imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void) => {
      WebAssembly.instantiate(module, imports).then(done, (error: unknown) => tell({ broken: String(error) }));
      return {};
    },
    onFrame: (kind: number, name: string, bytes: Frame['bytes']) => tell({ frame: { kind, name, bytes } }, [bytes.buffer]),
    print: () => undefined,
    printErr: () => undefined,
  }) as Promise<Engine>;
}

async function work(task: Uint8Array): Promise<void> {
  const of = await engine!;
  const at = of._malloc(task.length);
  if (at === 0) throw new Error('memory');
  of.HEAPU8.set(task, at);
  of._popcut_answer(at, task.length);
  of._free(at);
  tell({ done: true, bytes: of.HEAPU8.length });
}

onmessage = ({ data }: MessageEvent<ToWorker>) => {
  if ('module' in data) engine = start(data.module);
  else work(data.task).catch((error: unknown) => tell({ broken: error instanceof Error ? error.message : String(error) }));
};
