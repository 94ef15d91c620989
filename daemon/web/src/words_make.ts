// SPDX-License-Identifier: MIT
// Texts of "Make it" and of what a drawing asks: loaded with them.
import { length, localized, size } from './words';

export const makeWords = localized({
  button: 'Make it…',
  title: 'Make it',
  back: 'Other ways',
  ways: {
    cut: { title: 'Cut here', what: 'with a cutter that is connected' },
    print: { title: 'Print, then cut here', what: 'a picture first; the cutter looks for the marks' },
    hand: { title: 'By hand', what: 'pages to print, with scissors or a knife' },
    cricut: { title: 'Cricut', what: 'an SVG for Design Space, folds as a layer to score' },
    silhouette: { title: 'Silhouette Studio', what: 'a DXF whose folds are dashes; also as SVG' },
    laser: { title: 'LightBurn and other lasers', what: 'an SVG with a colour for each operation' },
  } as Record<string, { title: string; what: string }>,
  printOnly: { title: 'Print a picture on it', what: 'the model in its colours, as a page for your printer' },
  noCutter: 'No cutter is connected.',
  steps: {
    hand: {
      first: 'Print sheets.pdf at actual size: 100 %, not "fit to page". Measure the bar: it must be 100 mm long.',
      second: 'Press the dashed lines with a bone folder or an empty pen. Then cut the solid lines, the outline last.',
      third: 'Fold with the printed side up: red dash-dot lines toward you, blue dashed lines away from you.',
    },
    cricut: {
      first: 'In Design Space choose Upload, take the SVG and add it to the canvas. Its size there must be the one below.',
      second: 'Set the red layer to Score. A green layer is for the Pen.',
      third: 'Select all, press Attach, then Make.',
    },
    silhouette: {
      first: 'In Silhouette Studio set Edit, Preferences, Import, DXF to open "As-Is", not "Fit-to-Page". Then drag the DXF onto the page. Its size must be the one below.',
      second: 'Set all lines to Cut: each fold is a row of short cuts. If Studio shows their colours, cut red (folds) before black.',
      third: 'Choose your mat and paper, put the drawing where the picture has it, and send it.',
    },
    laser: {
      first: 'In LightBurn choose File, then Import, and take the SVG. Its size must be the one below.',
      second: 'Each colour is a layer in Line mode: red and blue are folds, in dashes; black is cut. Keep that order, black last.',
      third: 'Frame the sheet, then start. Try power and speed on a scrap of the same paper first.',
    },
  } as Record<string, Record<string, string>>,
  svgToo: 'Larger editions of Silhouette Studio open the SVG, too.',
  paper: 'Paper',
  machine: 'Machine',
  papers: {
    '': '12 × 12 in mat', A4: 'A4', letter: 'Letter', A3: 'A3', '12x12in': '12 × 12 in', '12x24': '12 × 24 in mat', '4.5x12': '4.5 × 12 in mat', '300x200': '300 × 200 mm', '600x400': '600 × 400 mm',
  } as Record<string, string>,
  cricuts: {
    'cricut-maker': 'Maker', 'cricut-explore': 'Explore', 'cricut-joy-xtra': 'Joy Xtra', 'cricut-joy': 'Joy',
  } as Record<string, string>,
  largestMat: 'its first mat',
  making: 'Making the sheets…',
  sheet: (k: number, n: number): string => `Sheet ${k} of ${n}`,
  sheetSize: (w: number, h: number, cut: number, fold: number): string => `${size(w, h)}; ${length(cut)} to cut, ${length(fold)} of folds`,
  page: (w: number, h: number): string => `The pages are ${size(w, h)}.`,
  save: (name: string): string => `Save ${name}`,
  command: 'The same on the command line:',
  more: 'More: other formats',

  drawing: {
    title: 'What are these lines for?',
    what: 'The drawing does not say it. Look at our guess and change what is wrong; popcut keeps the answer for this drawing.',
    yes: 'Yes, use these',
    done: 'Size and lines of the drawing',
    sides: 'The drawing has folds and does not say to which side. Choose where that matters.',
    dashes: 'Dashed lines are cut as dashes. Where lines are folds, say to which side: then the card is shown as it opens.',
    asDrawn: 'as drawn',
    anySide: 'either side',
    of: (name: string, mm: number): string => `${name}, ${length(mm)}`,
    colours: {
      '#000000': 'black', '#ff0000': 'red', '#0000ff': 'blue', '#00ff00': 'light green', '#008000': 'green', '#ffff00': 'yellow', '#ff00ff': 'magenta',
      '#00ffff': 'cyan', '#808080': 'grey', '#ffffff': 'white',
    } as Record<string, string>,
    choose: 'choose…',
    uses: {
      cut: 'cut', fold: 'fold', 'fold-mountain': 'mountain fold', 'fold-valley': 'valley fold', score: 'score', draw: 'draw', ignore: 'leave out',
    } as Record<string, string>,
    unit: 'How large is it?',
    unitWhat: 'The file does not say its unit. Choose the right size; nothing is planned before.',
    units: { mm: 'in mm', cm: 'in cm', in: 'in inches' } as Record<string, string>,
    size: (w: number, h: number): string => `The drawing is ${size(w, h)}.`,
    option: 'On the command line',
  },
});
