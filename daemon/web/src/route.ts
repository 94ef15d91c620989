// Where the page is: the part of the address after '#'.
import './one_shot';
import { signal } from '@preact/signals';

export interface Route { view: string; rest: string }

/** `#/at/sim%3Aa` is {view: 'at', rest: 'sim:a'}. A broken escape stays as it is. */
export function parseRoute(hash: string): Route {
  const [, view = '', rest = ''] = /^#?\/?([^/]*)\/?(.*)$/.exec(hash) ?? [];
  let plain = rest;
  try {
    plain = decodeURIComponent(rest);
  } catch {
    // a shared link that was cut off
  }
  return { view: view || 'now', rest: plain };
}

export const route = signal<Route>(parseRoute(location.hash));
addEventListener('hashchange', () => { route.value = parseRoute(location.hash); });

export const atDevice = (id: string): string => `#/at/${encodeURIComponent(id)}`;
export const sheetsOf = (plan: string): string => `#/sheets/${plan}`;
export const glueOf = (plan: string): string => `#/glue/${plan}`;
/** How to fold a design, step by step. */
export const foldOf = (design: string): string => `#/fold/${design}`;
export const go = (hash: string): void => { location.hash = hash; };
