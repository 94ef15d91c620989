// SPDX-License-Identifier: MIT
// Who answers the page's requests: popcutd, or in the page of static files the engine in this browser. Nothing else in
// the page knows which; what there is to ask for stands in `can` of /v1/meta.
import { signal } from '@preact/signals';

declare const LOCAL: boolean;

/** Whether one signs in first. */
export const signsIn = !LOCAL;

/** What this browser cannot keep until another day; null: it keeps everything, or nothing is to be kept in it. */
export const storeTrouble = signal<'forbidden' | 'full' | null>(null);

/** A newer page is ready, where pages wait until they are wanted. */
export const newer = signal(false);

/** What is done once, when the page begins. */
export function begin(): void {
  if (LOCAL) void import('./local/installed').then((module) => module.install());
}

/** The view of what this browser keeps, where it keeps anything. */
export const loadKept = LOCAL ? () => import('./kept') : null;

/** Shows the newer page, where one is there. */
export async function reload(): Promise<void> {
  if (LOCAL && newer.peek()) await (await import('./local/installed')).takeOver();
  location.reload();
}

type Answer = (path: string, init: RequestInit) => Promise<Response>;
let local: Promise<Answer> | null = null;

/** The answer to a request. Throws where none comes. */
export async function answer(path: string, init: RequestInit): Promise<Response> {
  if (LOCAL) {   // not `!LOCAL`: so the bundler sees that popcutd's page has nothing of this
    local ??= import('./local/answers').then((module) => module.answer);
    return (await local)(path, init);
  }
  return fetch(path, { credentials: 'omit', redirect: 'error', ...init });
}
