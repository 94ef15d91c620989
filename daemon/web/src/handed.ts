// SPDX-License-Identifier: MIT
// Files that somebody drops anywhere, or chooses, until Design opens them.
import { signal } from '@preact/signals';
import { go, route } from './route';

/** What was given; entries are there where folders may be among it. */
export interface Handed {
  entries: FileSystemEntry[];
  files: File[];
}

export const handed = signal<Handed | null>(null);

export function hand(files: Handed): void {
  handed.value = files;
  if (route.peek().view !== 'design') go('#/design');
}

/** Takes what is dropped on the page, which the browser would show in its place. A question that is open stays. */
export function takeDrops(): void {
  const mark = (on: boolean): void => void document.body.classList.toggle('drop-over', on);
  addEventListener('dragover', (event) => {
    if (!event.dataTransfer?.types.includes('Files')) return;
    event.preventDefault();
    mark(true);
  });
  addEventListener('dragleave', (event) => { if (event.relatedTarget === null) mark(false); });
  addEventListener('drop', (event) => {
    const from = event.dataTransfer;
    if (!from?.types.includes('Files')) return;
    event.preventDefault();
    mark(false);
    if (document.querySelector('dialog[open]') && route.peek().view !== 'design') return;
    // Both are there only while the event is handled.
    hand({ entries: [...from.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null), files: [...from.files] });
  });
}
