// SPDX-License-Identifier: MIT
// The cutter and the paper that a person chose, and what they mean for searches and plans.
import { computed, signal } from '@preact/signals';
import type { Machine } from './model';
import { cutter, kByHand, paper, prints } from './preferences';
import { isProblem, read } from './server';
import { can, devices } from './store';
import { size } from './words';
import { designWords } from './words_design';

/** A paper or a mat; `name` is that of the option `mat`. */
export interface Paper {
  name: string;
  title: string;
  width_mm: number;
  length_mm: number;
}

/** The machine of who cuts by hand. */
export const kNone = 'none';
const kUsualMachine = 'cameo3';    // whose times tell cards apart where nobody cuts with a machine
const kSizes: [string, number, number][] = [['A4', 210, 297], ['letter', 215.9, 279.4], ['A3', 297, 420], ['12x12in', 304.8, 304.8]];
const kLetterCountries = ['US', 'CA', 'MX', 'CL', 'CO', 'PH'];

const kUsualMaterial = 'paper-220';

const machines = signal<Machine[]>([]);
const materialTitles = signal<ReadonlyMap<string, string>>(new Map());
interface MaterialRow { id: string; material?: { title?: string } | null }

/** Reads a list once, and again if it could not be read. */
function once<Row>(path: string, take: (rows: Row[]) => void): () => Promise<void> {
  let asked = false;
  return async () => {
    if (asked) return;
    asked = true;
    try {
      take((await read<{ items: Row[] }>(path)).items);
    } catch (error) {
      asked = false;
      if (!isProblem(error)) throw error;
    }
  };
}

/** Reads what machines there are. */
export const readMachines = once<Machine>('/v1/machines', (rows) => { machines.value = rows; });

/** Reads what materials there are. */
export const readMaterials = once<MaterialRow>('/v1/materials?limit=200', (rows) => {
  materialTitles.value = new Map(rows.map((row) => [row.id, row.material?.title ?? row.id]));
});

/** What people call a material and a machine. */
export const materialTitle = (id: string): string => materialTitles.value.get(id) ?? id;
export const machineTitle = (name: string): string => machines.value.find((one) => one.name === name)?.title ?? name;

/** Materials to choose from; '' is that of a design of `own`. */
export const materialChoice = (own: string): [string, string][] =>
  [['', materialTitle(own || kUsualMaterial)], ...[...materialTitles.value].filter(([id]) => id !== (own || kUsualMaterial))];

/** The cutter that is meant: one that is not there any more is not. */
export const chosenCutter = computed(() => (cutter.value === kByHand || devices.value.has(cutter.value) ? cutter.value : ''));

/** The cutter that is meant where nobody chose one. */
export const firstCutter = computed(() => [...devices.value.values()].find((one) => one.state !== 'absent') ?? [...devices.value.values()][0]);

/** What there is to choose from: each cutter once, or in place of one what is planned for. */
export const cutters = computed((): [string, string][] => (firstCutter.value ? [...devices.value.values()].map((one) => [one.id, one.title])
  : [['', can('devices') ? designWords.outfit.none : designWords.outfit.usual]]));

/** The machine that is meant; null: not known yet. */
export const machine = computed<Machine | null>(() => {
  const device = devices.value.get(chosenCutter.value) ?? firstCutter.value;
  const name = chosenCutter.value === kByHand ? kNone : device?.machine ?? kUsualMachine;
  return machines.value.find((one) => one.name === name) ?? null;
});

/** What the chosen cutter takes: usual papers, then its own mats. */
export const papers = computed<Paper[]>(() => {
  const of = machine.value;
  const titles: Record<string, string> = designWords.outfit.papers;
  const fits = ([, width, length]: [string, number, number]): boolean => !of || (width <= of.width_mm + 0.1 && length <= of.length_mm + 0.1);
  const own = (of?.name === kNone ? [] : of?.mats ?? []).map((mat): Paper => ({ ...mat, title: designWords.outfit.mat(mat.name) }));
  const same = (a: Paper, b: Paper): boolean => Math.abs(a.width_mm - b.width_mm) < 1 && Math.abs(a.length_mm - b.length_mm) < 1;
  const usual = kSizes.filter(fits).map(([name, width_mm, length_mm]): Paper => ({ name, title: titles[name] ?? name, width_mm, length_mm }));
  return [...usual.filter((one) => !own.some((mat) => same(mat, one))), ...own];
});

/** What a planned sheet lies on, as people call it. */
export function paperTitle(of: { mat: string | null; area_mm: number[] }): string {
  const [width, length] = of.area_mm as [number, number];
  const known = kSizes.find((one) => Math.abs(one[1] - width) < 1 && Math.abs(one[2] - length) < 1);
  const title = known && designWords.outfit.papers[known[0]];
  return title ?? (of.mat ? designWords.outfit.mat(of.mat) : size(width, length));
}

function usualPaper(): string {
  const country = /-([A-Z]{2})\b/.exec(navigator.language)?.[1];
  return country && kLetterCountries.includes(country) ? 'letter' : 'A4';
}

/** The paper that is meant: the chosen one if the cutter takes it. */
export const chosenPaper = computed<Paper | null>(() => {
  const named = (name: string): Paper | undefined => papers.value.find((one) => one.name === name || one.name === name.replace(/in$/, ''));
  return named(paper.value) ?? named(usualPaper()) ?? papers.value[0] ?? null;
});

/** Whether the cutter looks for marks on a printed sheet. */
export const canFindMarks = computed(() => machine.value?.marks_take_mm !== null);

/** Whether cards get room for marks, and marks. */
export const marked = computed(() => prints.value === 'yes' && canFindMarks.value && chosenCutter.value !== kByHand);

/** What the margins and the legend of a page to cut by hand take, mm: kPrintSideMm and kPrintFooterMm of core/layout. */
const kHandTakes_mm = [16, 38];
const kRounding_mm = 0.01;   // a card as large as its room fits it

/** Width and length that a card may have, mm: of the paper, of what lies between its marks, or of what is printed. */
export const room = computed<[number, number] | null>(() => {
  const of = chosenPaper.value;
  const takes = chosenCutter.value === kByHand ? kHandTakes_mm : marked.value && machine.value?.marks_take_mm || [0, 0];
  return of && [of.width_mm - takes[0]! + kRounding_mm, of.length_mm - takes[1]! + kRounding_mm];
});

const kMostMargin_mm = 30;

/** The factor by which a card of this size, of which `margin_mm` stays as it is, is to be made smaller or larger to fill `room`. */
export function fillFactor(width_mm: number, length_mm: number, margin_mm = Math.min(kMostMargin_mm, width_mm / 3)): number {
  const of = room.value;
  if (!of) return 1;
  const factor = (a: number, b: number): number => Math.min((a - margin_mm) / Math.max(1, width_mm - margin_mm), (b - margin_mm) / Math.max(1, length_mm - margin_mm));
  return Math.floor(1000 * Math.max(factor(...of), factor(of[1], of[0]))) / 1000;
}

/** Members of the request of a search. */
export function searchWishes(): Record<string, unknown> {
  const of = chosenCutter.value;
  return {
    ...(of === kByHand ? { machine: kUsualMachine } : of !== '' ? { device: of } : {}),
    ...(room.value ? { mat: of === kByHand ? room.value.map((mm) => mm.toFixed(1)).join('x') : chosenPaper.value!.name } : {}), marks: marked.value,
  };
}

/** Members of the request of a plan. `isPrinted`: the sheet is printed first. */
export function planWishes(isPrinted: boolean): Record<string, unknown> {
  const of = chosenCutter.value;
  const options: Record<string, unknown> = chosenPaper.value ? { mat: chosenPaper.value.name } : {};
  if (isPrinted && marked.value) options.marks = true;
  return { ...(of === kByHand ? { machine: kNone } : of !== '' ? { device: of } : {}), options };
}
