// SPDX-License-Identifier: MIT
// Texts on and about the drawing of a sheet.
import { integer, localized } from './words';

export const sheetWords = localized({
  feedEdge: 'feed edge',
  kinds: {
    cut: 'cut',
    outline: 'outline',
    slit: 'cut',
    mountain: 'mountain fold',
    valley: 'valley fold',
    score: 'score',
    fold: 'fold',
    draw: 'drawn line',
    mark: 'mark',
    label: 'label',
    tab: 'tab',
    other: 'line',
  },
  stroke: (kind: string, nth: number, of: number): string => `${kind} ${integer(nth)} of ${integer(of)}`,
  sentence: (strokes: number, size: string): string =>
    `Drawing of the sheet: ${integer(strokes)} ${strokes === 1 ? 'stroke' : 'strokes'} on ${size}`,
  fates: (certain: number, doubt: number, rest: number): string =>
    `${integer(certain)} certain, ${integer(doubt)} in doubt, ${integer(rest)} not cut`,
  empty: 'Drawing of the sheet: nothing is on it yet',
});
