// What a person can choose for a sheet whose cut broke off, and what each choice does to the strokes.
import type { Ledger } from './model';
import { strokesIn } from './ledger';

/** What resuming from a stroke means: how many are cut, how many of them again, how many stay in doubt. */
export interface Consequence { from: number; cuts: number; twice: number; uncut: number }

const within = (range: number[], stroke: number): boolean => stroke >= range[0]! && stroke <= range[1]!;

/**
 * The stroke from which the cut can go on, nearest to `wanted`: strokes in doubt go together, from their first; and no
 * stroke that was never sent is left out.
 */
export function startNear(ledger: Ledger, wanted: number): number {
  const doubt = ledger.in_doubt.find((range) => within(range, wanted));
  const start = doubt ? doubt[0]! : wanted;
  const unsent = ledger.not_sent[0]?.[0];
  return unsent !== undefined ? Math.min(start, unsent) : start;
}

const from = (ranges: number[][], start: number): number => strokesIn(ranges
  .filter(([, last]) => last! >= start).map(([first, last]) => [Math.max(first!, start), last!]));

/** What the strokes of `ledger` become if the cut goes on from `start`. */
export function consequence(ledger: Ledger, start: number): Consequence {
  const twice = from(ledger.certain, start) + from(ledger.in_doubt, start);
  return {
    from: start,
    cuts: twice + from(ledger.not_sent, start),
    twice,
    uncut: strokesIn(ledger.in_doubt) - from(ledger.in_doubt, start),
  };
}
