// Whether the design on the desk of this tab is kept nowhere but here.
import { signal } from '@preact/signals';

const kUnsaved = 'popcut.unsaved';

export const unsaved = signal(sessionStorage.getItem(kUnsaved) !== null);

/** Notes whether something would be lost with this tab. It outlives a reload. */
export function noteUnsaved(on: boolean): void {
  unsaved.value = on;
  if (on) sessionStorage.setItem(kUnsaved, '1');
  else sessionStorage.removeItem(kUnsaved);
}
