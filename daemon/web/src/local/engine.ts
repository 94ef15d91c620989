// SPDX-License-Identifier: MIT
// The engine in Web Workers. A task that is not wanted any more ends its worker; a worker that breaks costs its task only.
import { framesOf, Kind, type Frame, type Task } from './frames';
import type { FromWorker, ToWorker } from './worker';

/** Why a task gave no frames. */
export class EngineBroken extends Error {}

/** Where a file of this site lies: its name has a hash, which index.html knows. */
export const placeOf = (name: string): string => new URL(document.querySelector<HTMLMetaElement>(`meta[name=${name}]`)!.content, document.baseURI).href;

interface Policies { createPolicy(name: string, rules: { createScriptURL(address: string): string }): { createScriptURL(address: string): string } }
const policies = (window as unknown as { trustedTypes?: Policies }).trustedTypes;
let policy: ReturnType<Policies['createPolicy']> | null = null;
/** An address of this site that a worker may be started from. */
export function scriptAt(address: string): string {
  if (!policies) return address;
  policy ??= policies.createPolicy('popcut', { createScriptURL: (own) => own });
  return policy.createScriptURL(address);
}

let compiled: Promise<WebAssembly.Module> | null = null;
/** Compiled once for all workers, while it comes. A server that does not know .wasm costs a second. */
export function module(): Promise<WebAssembly.Module> {
  const compile = async (cache: RequestCache): Promise<WebAssembly.Module> => {
    const answer = await fetch(placeOf('engine'), { cache });
    if (!answer.ok) throw new EngineBroken(`the engine cannot be loaded (${answer.status}); reload the page`);
    if (answer.headers.get('Content-Type')?.startsWith('application/wasm')) return WebAssembly.compileStreaming(answer);
    return WebAssembly.compile(await answer.arrayBuffer());
  };
  const again = (error: unknown): Promise<WebAssembly.Module> => {   // what a cache has of it can be broken
    if (error instanceof EngineBroken) throw error;
    return compile('reload');
  };
  compiled ??= compile('default').catch(again).catch((error: unknown) => {
    compiled = null;
    throw error instanceof EngineBroken ? error : new EngineBroken('the engine cannot be loaded; check the connection and reload the page');
  });
  return compiled;
}

async function newWorker(): Promise<Worker> {
  const of = await module();
  const worker = new Worker(scriptAt(placeOf('engine-worker')));
  worker.postMessage({ module: of } satisfies ToWorker);
  return worker;
}

/** Memory of a worker above which it is replaced after a task: it never gives any back. */
const kMuch = 512 << 20;
/** How long a task that is not wanted any more may still run before its worker is ended, ms. */
const kGrace_ms = 80;
/** How long nobody asks for anything until a worker rehearses, ms. */
const kRest_ms = 300;

/** A line of tasks, done one after the other. */
export class Lane {
  private worker: Promise<Worker> | null = null;
  private spare: Promise<Worker> | null = null;
  private rehearsal: Promise<Worker> | null = null;   // the spare, while it rehearses
  private toRehearse: Task[] = [];
  private rest: ReturnType<typeof setTimeout> | undefined;
  private tasks = 0;   // that wait or are done
  private tail: Promise<unknown> = Promise.resolve();

  /** @param keepsSpare  a second worker stands by, since tasks are called off often */
  constructor(private readonly keepsSpare = false) {}

  /** Loads what the first task needs. */
  warm(): void {
    this.worker ??= newWorker();
    this.worker.catch(() => { this.worker = null; });
  }

  /**
   * Has the worker that stands by do tasks of which nobody wants anything: a browser compiles code well only once it has
   * run for a while, and then for all workers. Any other task comes first.
   */
  rehearse(tasks: Task[]): void {
    this.toRehearse = tasks;
    this.restOver();
  }

  private restOver(): void {
    clearTimeout(this.rest);
    if (this.tasks > 0 || this.toRehearse.length === 0) return;
    this.rest = setTimeout(() => {
      const spare = this.spare ??= newWorker();
      this.rehearsal = spare;
      spare.then((worker) => this.rehearseIn(worker, spare), () => { this.spare = this.rehearsal = null; });
    }, kRest_ms);
  }

  private rehearseIn(worker: Worker, spare: Promise<Worker>): void {
    const next = (): void => {
      if (this.rehearsal !== spare) return;   // it was ended
      const task = this.toRehearse[0];
      if (!task) this.rehearsal = worker.onmessage = worker.onerror = null;
      else worker.postMessage({ task: framesOf(task) } satisfies ToWorker);
    };
    const fails = (): void => {
      this.toRehearse = [];
      this.endRehearsal();
    };
    worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
      if ('frame' in data || this.rehearsal !== spare) return;
      if ('broken' in data) return fails();
      this.toRehearse.shift();
      return next();
    };
    worker.onerror = (event) => {
      event.preventDefault();
      fails();
    };
    next();
  }

  private endRehearsal(): void {
    clearTimeout(this.rest);
    if (!this.rehearsal) return;
    void this.rehearsal.then((worker) => worker.terminate(), () => undefined);
    this.spare = this.rehearsal = null;
  }

  /** The frames of a task, without phases, which `onPhase` gets. Throws what `signal` says, EngineBroken. */
  run(task: Task, signal?: AbortSignal | null, onPhase?: (text: string) => void): Promise<Frame[]> {
    this.tasks++;
    this.endRehearsal();
    const mine = this.tail.then(() => this.one(task, signal, onPhase));
    this.tail = mine.catch(() => undefined).then(() => {
      this.tasks--;
      this.restOver();
    });
    return mine;
  }

  private async one(task: Task, signal: AbortSignal | null | undefined, onPhase?: (text: string) => void): Promise<Frame[]> {
    signal?.throwIfAborted();
    this.warm();
    const worker = await this.worker!;
    if (this.keepsSpare) this.spare ??= newWorker();
    const frames: Frame[] = [];
    let calledOff = (): void => undefined;
    try {
      await new Promise<void>((done, failed) => {
        let over: ReturnType<typeof setTimeout> | undefined;
        const end = (why: unknown): void => {
          clearTimeout(over);
          this.drop(worker);
          failed(why);
        };
        calledOff = () => { over = setTimeout(() => end(signal!.reason), kGrace_ms); };
        signal?.addEventListener('abort', calledOff);
        worker.onmessage = ({ data }: MessageEvent<FromWorker>) => {
          if ('broken' in data) return end(new EngineBroken(data.broken));
          if ('frame' in data) {
            if (data.frame.kind !== Kind.phase) frames.push(data.frame);
            else onPhase?.(new TextDecoder().decode(data.frame.bytes));
            return undefined;
          }
          clearTimeout(over);
          if (data.bytes > kMuch) this.drop(worker);
          return done();
        };
        worker.onerror = (event) => {
          event.preventDefault();
          end(new EngineBroken(event.message || 'its worker ended'));
        };
        const bytes = framesOf(task);
        worker.postMessage({ task: bytes } satisfies ToWorker, [bytes.buffer]);
      });
    } finally {
      worker.onmessage = worker.onerror = null;
      signal?.removeEventListener('abort', calledOff);   // else it would end the worker of the next task
    }
    signal?.throwIfAborted();
    return frames;
  }

  private drop(worker: Worker): void {
    worker.terminate();
    this.worker = this.spare;
    this.spare = null;
  }
}
