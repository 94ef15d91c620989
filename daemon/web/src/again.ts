// Reading again what could not be read: popcutd was away, or the session was over.
import { computed, effect, useSignal } from '@preact/signals';
import { useEffect } from 'preact/hooks';
import { session, type ServerProblem } from './server';
import { connection } from './store';

const kGap_ms = 3000;       // twice as long with each time
const kMostGap_ms = 30_000;

/** popcutd takes what we ask: we are signed in, and its events come. */
export const isThere = computed(() => session.value === 'in' && connection.value.open);

/**
 * A number for the dependencies of an effect that reads: it grows when what `problem` says may have passed, that is
 * when popcutd is back or we are signed in again.
 */
export function useAgain(problem: ServerProblem | null): number {
  const times = useSignal(0);
  useEffect(() => {
    if (problem === null || (problem.status !== 0 && problem.status !== 401)) return undefined;
    // It is there already: the gap was so short that nobody else noticed.
    let timer = isThere.peek() ? setTimeout(() => { times.value++; }, Math.min(kMostGap_ms, kGap_ms * 2 ** Math.min(times.peek(), 4))) : undefined;
    let before = isThere.peek();
    const stop = effect(() => {
      const now = isThere.value;
      if (now && !before) timer = setTimeout(() => { times.value++; }, 0);
      before = now;
    });
    return () => { stop(); clearTimeout(timer); };
  }, [problem]);
  return times.value;
}
