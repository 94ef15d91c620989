// Requests to popcutd. The token lives in sessionStorage and leaves by `fetch` alone.
import { signal } from '@preact/signals';
import { answer as answerOf, signsIn } from './backend';
import type { ProblemEntry, Warning, Way } from './model';
import { tabStore } from './tab_store';

const kToken = 'popcut.token';

/** none: never signed in here; in: has a token; over: popcutd no longer takes the token. */
export const session = signal<'none' | 'in' | 'over'>(!signsIn || tabStore.getItem(kToken) ? 'in' : 'none');

/** popcutd asked to wait until then (ms since 1970), or 0. */
export const waitsUntil = signal(0);

/** Why a request did not do what it should. `status` is 0 if no answer came. */
export class ServerProblem extends Error {
  readonly status: number;
  readonly kind: string;
  readonly detail: string;
  readonly errors: ProblemEntry[];
  readonly rev: number | null;
  readonly state: string | null;
  readonly ways: Way[];
  readonly warnings: Warning[];
  readonly requestId: string;
  readonly retryAfter_s: number;

  constructor(status: number, body: Record<string, unknown>, retryAfter_s = 0) {
    const kind = typeof body.type === 'string' ? body.type.slice(body.type.lastIndexOf('/') + 1) : 'other';
    super(`${status} ${kind}`);
    this.status = status;
    this.kind = status === 0 ? 'unreachable' : kind;
    this.detail = typeof body.detail === 'string' ? body.detail : '';
    this.errors = Array.isArray(body.errors) ? body.errors as ProblemEntry[] : [];
    this.rev = typeof body.rev === 'number' ? body.rev : null;
    this.state = typeof body.state === 'string' ? body.state : null;
    this.ways = Array.isArray(body.ways) ? body.ways as Way[] : [];
    this.warnings = Array.isArray(body.warnings) ? body.warnings as Warning[] : [];
    this.requestId = typeof body.request_id === 'string' ? body.request_id : '';
    this.retryAfter_s = retryAfter_s;
  }

  /** The same about the file `asset` of a spec, under the name that a person knows it by, without the place in the spec. */
  naming(asset: string, name: string): ServerProblem {
    const named = (text: string): string => text.replaceAll(asset, name).replace(/^\/surface(\/file)?: /, '');
    return new ServerProblem(this.status, {
      type: this.kind, detail: named(this.detail), request_id: this.requestId,
      errors: this.errors.map((one) => ({ ...one, detail: named(one.detail) })),
    }, this.retryAfter_s);
  }
}

export function isProblem(error: unknown): error is ServerProblem {
  return error instanceof ServerProblem;
}

export interface Ask {
  body?: unknown;                       // sent as JSON
  raw?: { bytes: BodyInit; type: string };
  key?: string;                         // Idempotency-Key
  rev?: number | '*';                   // If-Match, the revision that was shown
  headers?: Record<string, string>;
  accept?: string;
  signal?: AbortSignal;
  stops?: boolean;                      // stops a knife: sent even if the session seems to be over
}

/** A key for one act, kept by whoever acts until the act is answered. */
export function newKey(): string {
  return crypto.randomUUID();
}

/** Keeps the token of a session; every later request carries it. */
export function signInWith(token: string): void {
  tabStore.setItem(kToken, token);
  session.value = 'in';
}

/** Forgets the token, whether or not popcutd could be told. */
export async function signOut(): Promise<void> {
  await send('DELETE', '/v1/session').catch(() => undefined);
  tabStore.removeItem(kToken);
  session.value = 'none';
}

/** Changes a one-shot word into a session. Throws ServerProblem. */
export async function signInWithWord(word: string): Promise<void> {
  const { token } = await openAsk<{ token: string }>('/v1/session', { one_shot: word });
  signInWith(token);
}

/** POST without a token: how a session begins. Throws ServerProblem. */
export async function openAsk<T>(path: string, body: unknown, signal?: AbortSignal): Promise<T & { status: number }> {
  const answer = await answered(path, {
    method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body), signal,
  });
  return { ...await answer.json() as T, status: answer.status };
}

/**
 * The answer to a request, whatever its form. Throws ServerProblem, also if no answer comes. When the session is over
 * nothing is sent: popcutd would count it as a failed login.
 */
export async function request(method: string, path: string, ask: Ask = {}): Promise<Response> {
  const headers: Record<string, string> = { Accept: ask.accept ?? 'application/json', ...ask.headers };
  const token = tabStore.getItem(kToken);
  if (session.peek() === 'over' && !ask.stops) throw new ServerProblem(401, { type: 'unauthenticated' });
  if (token) headers.Authorization = `Bearer ${token}`;
  if (ask.key) headers['Idempotency-Key'] = ask.key;
  if (ask.rev !== undefined) headers['If-Match'] = ask.rev === '*' ? '*' : `"${ask.rev}"`;
  if (ask.raw) headers['Content-Type'] = ask.raw.type;
  else if (ask.body !== undefined) headers['Content-Type'] = 'application/json';
  try {
    return await answered(path, {
      method, headers, body: ask.raw?.bytes ?? (ask.body === undefined ? undefined : JSON.stringify(ask.body)),
      signal: ask.signal, cache: method === 'GET' ? 'default' : 'no-store',
    });
  } catch (error) {
    if (isProblem(error) && error.status === 401 && token === tabStore.getItem(kToken)) session.value = 'over';
    throw error;
  }
}

async function answered(path: string, init: RequestInit): Promise<Response> {
  let answer: Response;
  try {
    answer = await answerOf(path, init);
  } catch (error) {
    if (init.signal?.aborted) throw error;
    throw new ServerProblem(0, { type: 'unreachable' });
  }
  if (answer.ok || answer.status === 304) return answer;
  const body = await answer.json().catch(() => ({})) as Record<string, unknown>;
  throw new ServerProblem(answer.status, body, Number(answer.headers.get('Retry-After')) || 0);
}

const pause_ms = (ms: number, signal?: AbortSignal): Promise<void> => new Promise((done, failed) => {
  const timer = setTimeout(done, ms);
  signal?.addEventListener('abort', () => { clearTimeout(timer); failed(signal.reason); }, { once: true });
});

/** Reads; waits and repeats by itself, three times at most, if popcutd asks for that. Throws ServerProblem. */
export async function readAnswer(path: string, ask: Ask = {}): Promise<Response> {
  for (let attempt = 0; ; ++attempt) {
    try {
      return await request('GET', path, ask);
    } catch (error) {
      if (!isProblem(error) || (error.status !== 429 && error.status !== 503) || attempt === 3) throw error;
      const wait_ms = Math.min(30, error.retryAfter_s || 1) * 1000;
      waitsUntil.value = Date.now() + wait_ms;
      await pause_ms(wait_ms, ask.signal);
    }
  }
}

/** Reads JSON. Throws ServerProblem. */
export async function read<T>(path: string, ask: Ask = {}): Promise<T> {
  return await (await readAnswer(path, ask)).json() as T;
}

/** Reads bytes, a picture for example. Throws ServerProblem. */
export async function readBlob(path: string, ask: Ask = {}): Promise<Blob> {
  return await (await readAnswer(path, { accept: '*/*', ...ask })).blob();
}

/** Changes something, once; never repeats by itself. JSON answers only. Throws ServerProblem. */
export async function send<T>(method: string, path: string, ask: Ask = {}): Promise<T> {
  const answer = await request(method, path, ask);
  return (answer.status === 204 ? null : await answer.json()) as T;
}

/** Offers `blob` to be saved as a file. */
export function saveAs(blob: Blob, name: string): void {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

const openKeys = new Map<string, string>();

/**
 * An act of a person on a job, a device or the queue: POST with If-Match of what was shown. Its key is made at the
 * press and kept until popcutd answers, so that pressing again after a lost answer asks for the same act, not for a
 * second one. Throws ServerProblem.
 */
export async function act<T>(path: string, rev: number | '*' | undefined, body: unknown): Promise<T> {
  const what = JSON.stringify([path, rev ?? null, body]);
  const key = openKeys.get(what) ?? newKey();
  openKeys.set(what, key);
  for (let attempt = 0; ; ++attempt) {
    try {
      const answer = await send<T>('POST', path, { body, key, rev });
      openKeys.delete(what);
      return answer;
    } catch (error) {
      if (!isProblem(error) || error.status === 0) throw error;
      if (error.kind === 'idempotency-in-progress' && attempt < 20) {
        await pause_ms(300);
        continue;
      }
      openKeys.delete(what);
      throw error;
    }
  }
}
