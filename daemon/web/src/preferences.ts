// What this browser prefers. Kept in localStorage: never a token, never a design.
import { effect, signal, type Signal } from '@preact/signals';

export type Units = 'mm' | 'inch';
export type Theme = 'system' | 'light' | 'dark';
export type Language = 'en' | 'pseudo';

function kept<T extends string>(name: string, allowed: readonly T[], fallback: T): Signal<T> {
  const stored = readStored(name);
  const value = signal<T>(allowed.includes(stored as T) ? stored as T : fallback);
  effect(() => writeStored(name, value.value === fallback ? null : value.value));
  return value;
}

function readStored(name: string): string | null {
  try {
    return localStorage.getItem(`popcut.${name}`);
  } catch {
    return null;     // storage is switched off: the preference lasts as long as the page
  }
}

function writeStored(name: string, value: string | null): void {
  try {
    if (value === null) localStorage.removeItem(`popcut.${name}`);
    else localStorage.setItem(`popcut.${name}`, value);
  } catch {
    // as above
  }
}

/** A text that this browser keeps; null: none. */
export const keptText = readStored;
export const keepText = writeStored;

export const units = kept<Units>('units', ['mm', 'inch'], 'mm');
export const theme = kept<Theme>('theme', ['system', 'light', 'dark'], 'system');
export const language = kept<Language>('language', ['en', 'pseudo'], 'en');

/** A text that is kept; '' is not. */
function keptSignal(name: string): Signal<string> {
  const value = signal(readStored(name) ?? '');
  effect(() => writeStored(name, value.value || null));
  return value;
}

/** The id of the cutter beside which this screen stands, or ''. */
export const beside = keptSignal('beside');

/** What a person cuts with and on, chosen once: the id of a cutter or `kByHand`; a paper or mat by its name. '': not chosen yet. */
export const cutter = keptSignal('cutter');
export const paper = keptSignal('paper');
export const kByHand = 'by-hand';
/** Whether what is on the desk is printed before it is cut. */
export const prints = kept<'yes' | 'no'>('prints', ['yes', 'no'], 'no');

effect(() => {
  if (theme.value === 'system') delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = theme.value;
});
