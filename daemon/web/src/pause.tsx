// PAUSE: always reachable, sent at the touch, and honest about whether it arrived.
import { signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { atDevice, route } from './route';
import { isProblem, newKey, send, type ServerProblem } from './server';
import { deviceTitle, isPausing, may, me, pausable, takeJob } from './store';
import type { Job } from './model';
import { remaining } from './now';
import { Button } from './parts';
import { timeRange, words } from './words';

const kSilent_ms = 1000;     // no answer for so long: NOT SENT
const kRepeat_ms = 500;
const kGiveUp_ms = 10_000;
const kAtOnce = 3;           // requests under way at once; the oldest is dropped
const kShowThrough_ms = 6000;

/** What became of a press of PAUSE. */
export interface PauseTry {
  state: 'sending' | 'not-sent' | 'gave-up' | 'through' | 'refused';
  since: number;
  after_ms: number;                      // when it got through
  problem: ServerProblem | null;
}

export const pauseTries = signal<ReadonlyMap<string, PauseTry>>(new Map());

function note(job: string, change: Partial<PauseTry> | null): void {
  const next = new Map(pauseTries.value);
  const known = next.get(job);
  if (change === null) next.delete(job);
  else next.set(job, { state: 'sending', since: performance.now(), after_ms: 0, problem: null, ...known, ...change });
  pauseTries.value = next;
}

/**
 * Asks to pause `job`. One key for all repetitions, so that popcutd does it once. It is repeated each 0.5 s for 10 s
 * while no answer comes; pressing again meanwhile changes nothing.
 */
export function pauseJob(job: string): void {
  const state = pauseTries.peek().get(job)?.state;
  if (state === 'sending' || state === 'not-sent') return;
  const since = performance.now();
  const key = newKey();
  const underWay: AbortController[] = [];
  let over = false;
  let failed = 0;
  note(job, null);
  note(job, { state: 'sending', since });

  const finish = (change: Partial<PauseTry>): void => {
    over = true;
    clearTimeout(silent);
    clearInterval(repeat);
    clearTimeout(giveUp);
    note(job, change);
  };
  const answered = (change: Partial<PauseTry>): void => {
    const late = pauseTries.peek().get(job)?.state !== 'sending';
    finish({ ...change, after_ms: performance.now() - since });
    if (change.state === 'through') {
      const stays = late ? kShowThrough_ms : 0;
      setTimeout(() => { if (pauseTries.peek().get(job)?.since === since) note(job, null); }, stays);
    }
  };
  const once = (): void => {
    if (over) return;
    const abort = new AbortController();
    underWay.push(abort);
    if (underWay.length > kAtOnce) underWay.shift()!.abort();
    send<Job>('POST', `/v1/jobs/${job}/actions/pause`, { body: {}, key, rev: '*', signal: abort.signal, stops: true }).then(
      (now) => { if (!over) { answered({ state: 'through' }); takeJob(now); } },
      (error) => {
        if (over || !isProblem(error)) return;
        if (error.status === 0 || error.status === 503 || error.status === 429 || error.kind === 'idempotency-in-progress') {
          if (error.status === 0 && ++failed >= 2) note(job, { state: 'not-sent' });
          return;
        }
        answered({ state: 'refused', problem: error });
      });
  };
  const silent = setTimeout(() => note(job, { state: 'not-sent' }), kSilent_ms);
  const repeat = setInterval(once, kRepeat_ms);
  const giveUp = setTimeout(() => { finish({ state: 'gave-up' }); for (const one of underWay) one.abort(); }, kGiveUp_ms);
  once();
}

/** Pauses all that is being cut: what the key 'p' does. */
export function pauseAll(): void {
  for (const job of pausable.peek()) if (job.state === 'cutting' && mayPause(job)) pauseJob(job.id);
}

/** An operator may pause any job. */
export function mayPause(_job: Job): boolean {
  return me.value !== null && may('operator');
}

/** The button: acts as the finger comes down. A click without a pointer (keyboard, reader) acts as well. */
export function PauseButton({ job, big = false }: { job: Job; big?: boolean }) {
  const attempt = pauseTries.value.get(job.id);
  const unsent = attempt?.state === 'not-sent' || attempt?.state === 'gave-up';
  const pausing = !unsent && (isPausing(job) || attempt?.state === 'sending' || attempt?.state === 'through');
  return (
    <button type="button" data-safe class={`pause-button${big ? ' pause-big' : ''}${unsent ? ' pause-unsent' : ''}`}
      onPointerDown={(event) => { if (event.button === 0) pauseJob(job.id); }}
      onClick={(event) => { if (event.detail === 0) pauseJob(job.id); }}>
      <svg viewBox="0 0 24 24" aria-hidden="true"><path d="M6 4h4v16H6zM14 4h4v16h-4z" /></svg>
      {pausing ? words.pause.pausing : words.pause.pause}
    </button>
  );
}

/** Whether the press arrived, said where it was made. */
export function PauseNews({ job }: { job: string }) {
  const attempt = pauseTries.value.get(job);
  if (!attempt) return null;
  if (attempt.state === 'not-sent' || attempt.state === 'gave-up') {
    return (
      <p class="not-sent" role="alert">
        <strong>{words.pause.notSent}</strong> {words.pause.notSentWhat}
        {attempt.state === 'not-sent' && <> {words.pause.still}</>}
      </p>
    );
  }
  if (attempt.state === 'through' && attempt.after_ms > kSilent_ms) {
    return <p class="got-through" role="status">{words.pause.through((attempt.after_ms / 1000).toFixed(1))}</p>;
  }
  if (attempt.state === 'refused') {
    return (
      <p class="not-sent" role="alert">
        <strong>{words.pause.refused}</strong> {attempt.problem?.detail}
        <Button kind="quiet" onClick={() => note(job, null)}>{words.close}</Button>
      </p>
    );
  }
  return null;
}

/** Fixed at the bottom of every view while anything is cut or paused. */
export function PauseBar() {
  const bar = useRef<HTMLElement>(null);
  const all = pausable.value;
  const news = [...pauseTries.value.keys()].filter((id) => !all.some((job) => job.id === id));
  const shown = all.length > 0 || news.length > 0;
  useEffect(() => {
    if (!shown) return;
    // What lies above the bar keeps clear of it, however many cutters it names.
    const style = document.documentElement.style;
    const measure = new ResizeObserver(() => style.setProperty('--pause-height', `${bar.current?.offsetHeight ?? 0}px`));
    measure.observe(bar.current!);
    return () => { measure.disconnect(); style.removeProperty('--pause-height'); };
  }, [shown]);
  if (!shown) return null;
  return (
    <section ref={bar} class="pause-bar" aria-label={words.pause.pause}>
      {all.map((job) => (
        <div class="pause-row" key={job.id}>
          {job.state === 'paused' ? <strong class="pause-state">{words.pause.paused}</strong>
            : mayPause(job) ? <PauseButton job={job} big={route.value.view === 'at'} /> : <strong class="pause-state">{words.states.cutting}</strong>}
          <a href={job.device ? atDevice(job.device) : '#/'} class="pause-what">
            {words.pause.of(deviceTitle(job.device), job.name ?? words.unnamed)}
          </a>
          {job.state === 'cutting' && <span class="figure">{words.machine.left(timeRange(remaining(job)))}</span>}
          {job.state === 'cutting' && mayPause(job) && <span class="pause-hint">{words.pause.what}</span>}
          <PauseNews job={job.id} />
        </div>
      ))}
      {news.map((id) => <div class="pause-row" key={id}><PauseNews job={id} /></div>)}
    </section>
  );
}
