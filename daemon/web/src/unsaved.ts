// Whether the design on the desk of this tab is kept nowhere but here.
import { signal } from '@preact/signals';
import { tabStore } from './tab_store';

const kUnsaved = 'popcut.unsaved';

export const unsaved = signal(tabStore.getItem(kUnsaved) !== null);

/** Notes whether something would be lost with this tab. It outlives a reload. */
export function noteUnsaved(on: boolean): void {
  unsaved.value = on;
  if (on) tabStore.setItem(kUnsaved, '1');
  else tabStore.removeItem(kUnsaved);
}
