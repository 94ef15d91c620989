// SPDX-License-Identifier: MIT
// Texts of what this browser keeps: loaded with it.
import { integer, localized } from './words';

export const keptWords = localized({
  title: 'What this browser keeps',
  what: 'Your designs are in this browser only. Save them as one file to have them elsewhere, or in case its data are cleared.',
  none: 'Nothing yet: a design is kept once you make, plan or save something of it.',
  save: 'Save everything', open: 'Open a saved file…', file: 'popcut-designs.zip',
  taken: (n: number) => (n === 1 ? '1 design is kept here now.' : `${integer(n)} designs are kept here now.`),
  forget: 'Delete this design', clear: 'Delete everything', sure: 'Delete all designs, models and plans of this browser?',
  sureWhat: 'Nothing can bring them back, unless you saved them as a file.',
  unnamed: 'without a name',
});
