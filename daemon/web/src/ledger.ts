// The ledger of a sheet: what became of each stroke, in ranges that name their first and their last.
import type { Ledger } from './model';
import type { Fates } from './sheet_view';

const ends = (ranges: number[][]): [number, number][] => ranges.map(([first, last]) => [first!, last! + 1]);

/** A ledger as the sheet shows it: its ranges name their last stroke, those of the picture the one behind it. */
export function fatesOf(ledger: Ledger): Fates {
  return { certain: ends(ledger.certain), doubt: ends(ledger.in_doubt), done: 0 };
}

/** The same as it was when only the first `sent` strokes had been sent. */
export function fatesAfter(ledger: Ledger, sent: number): Fates {
  const until = (ranges: [number, number][]): [number, number][] => ranges
    .filter(([first]) => first < sent).map(([first, end]) => [first, Math.min(end, sent)]);
  const { certain, doubt } = fatesOf(ledger);
  return { certain: until(certain), doubt: until(doubt), done: 0 };
}

/** How many strokes were sent: all up to the last one that is certain or in doubt. */
export function strokesSent(ledger: Ledger): number {
  return Math.max(0, ...[...ledger.certain, ...ledger.in_doubt].map(([, last]) => last! + 1));
}

/** How many strokes ranges [first, last] hold. */
export function strokesIn(ranges: number[][]): number {
  return ranges.reduce((sum, [first, last]) => sum + last! - first! + 1, 0);
}
