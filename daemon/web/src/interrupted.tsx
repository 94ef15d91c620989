// A cut that broke off: what became of each stroke, and four ways on. None of them starts the cutter.
import type { ComponentChildren } from 'preact';
import { useEffect, useMemo, useRef, useState } from 'preact/hooks';
import { consequence, startNear, type Consequence } from './choices';
import { fatesAfter, fatesOf, strokesIn, strokesSent } from './ledger';
import type { Acts } from './machine';
import type { Job, Ledger, Way } from './model';
import { Button, Tick } from './parts';
import { read } from './server';
import { SheetPicture, useLedger, type SheetOfJob } from './sheet_picture';
import { strokeWords, type Strokes } from './sheet_view';
import { strokesAt } from './strokes';
import { localTime, may } from './store';
import { clockTime, hourMinuteSecond, words } from './words';

const say = words.interrupted;

type Kind = 'new' | 'go-on' | 'whole' | 'skip' | 'not-good' | 'give-up';
type Registration = 'kept' | 're-registered';

/** The ways that popcutd would take now; an event tells a job without them. */
function useWays(job: Job): Way[] {
  const [ways, setWays] = useState<Way[]>(job.ways ?? []);
  useEffect(() => {
    const stop = new AbortController();
    read<Job>(`/v1/jobs/${job.id}`, { signal: stop.signal }).then((one) => setWays(one.ways ?? []), () => undefined);
    return () => stop.abort();
  }, [job.id, job.rev]);
  return ways;
}

function Counts({ ledger, job }: { ledger: Ledger; job: Job }) {
  const attempt = ledger.attempts.at(-1);
  const reason = job.reason ? words.reasons[job.reason] ?? job.reason : '';
  return (
    <>
      <p>{attempt?.ended ? say.why(reason, hourMinuteSecond(localTime(attempt.ended))) : reason}</p>
      <ul class="fates figure">
        <li class="fate-certain">{say.certain(strokesIn(ledger.certain))}</li>
        <li class="fate-doubt">{say.doubt(strokesIn(ledger.in_doubt))}</li>
        <li class="fate-rest">{say.notCut(strokesIn(ledger.not_sent))}</li>
      </ul>
    </>
  );
}

const kPlayed_s = 8;

/** The cut up to where it broke off, again, in a few seconds. `onSent` gets how many strokes are shown; null: all. */
function Replay({ strokes, sent, onSent }: { strokes: Strokes; sent: number; onSent: (sent: number | null) => void }) {
  const all_s = sent > 0 ? strokes.stroke.end_s[sent - 1] ?? 0 : 0;
  const [time_s, setTime] = useState(all_s);
  const [playing, setPlaying] = useState(false);
  const frame = useRef(0);
  const stop = (): void => {
    cancelAnimationFrame(frame.current);
    setPlaying(false);
  };
  const show = (at_s: number): void => {
    setTime(at_s);
    onSent(at_s >= all_s ? null : Math.min(sent, strokesAt(strokes, at_s).begun));
  };
  useEffect(() => { stop(); setTime(all_s); }, [strokes, sent]);
  useEffect(() => () => cancelAnimationFrame(frame.current), []);
  const play = (): void => {
    if (playing) {
      stop();
      return;
    }
    setPlaying(true);
    let at_s = time_s >= all_s ? 0 : time_s;
    let last = performance.now();
    const tick = (now: number): void => {
      at_s = Math.min(all_s, at_s + ((now - last) / 1000) * Math.max(1, all_s / kPlayed_s));
      last = now;
      show(at_s);
      if (at_s < all_s) frame.current = requestAnimationFrame(tick);
      else stop();
    };
    frame.current = requestAnimationFrame(tick);
  };
  return (
    <div class="replay row">
      <Button onClick={play}>{playing ? say.replayStop : say.replay}</Button>
      <input type="range" min="0" max={all_s} step="any" value={time_s} aria-label={say.replayAt}
        aria-valuetext={`${clockTime(time_s)} / ${clockTime(all_s)}`} onInput={(event) => { stop(); show(Number(event.currentTarget.value)); }} />
      <output class="figure">{clockTime(time_s)} / {clockTime(all_s)}</output>
    </div>
  );
}

function Option({ kind, chosen, onChoose, title, children, disabled = false }: {
  kind: Kind; chosen: Kind | null; onChoose: (kind: Kind) => void; title: string; children: ComponentChildren; disabled?: boolean;
}) {
  const on = chosen === kind;
  return (
    <label class={`tick tick-big option${on ? ' tick-on' : ''}`}>
      <input type="radio" name="way" checked={on} disabled={disabled} onChange={() => onChoose(kind)} />
      <span><strong>{title}</strong><span class="option-what">{children}</span></span>
    </label>
  );
}

/** What going on from a stroke does; its risks are ticked, one by one. */
function GoOn({ what, effect, registration, onRegistration, canKeep, twice, onTwice, uncut, onUncut }: {
  what: string; effect: Consequence; registration: Registration; onRegistration: (value: Registration) => void;
  canKeep: boolean; twice: boolean; onTwice: (on: boolean) => void; uncut: boolean; onUncut: (on: boolean) => void;
}) {
  return (
    <div class="go-on">
      <p>{say.goOnFrom(what)} {say.goOnCuts(effect.cuts)}</p>
      <div class="ticks" role="radiogroup">
        {canKeep && (
          <label class="tick"><input type="radio" name="registration" checked={registration === 'kept'}
            onChange={() => onRegistration('kept')} /><span>{say.kept}</span></label>
        )}
        <label class="tick"><input type="radio" name="registration" checked={registration === 're-registered'}
          onChange={() => onRegistration('re-registered')} /><span>{say.reRegistered}</span></label>
        {effect.twice > 0 && <Tick checked={twice} onChange={onTwice}>{say.tickTwice(effect.twice)}</Tick>}
        {effect.uncut > 0 && <Tick checked={uncut} onChange={onUncut}>{say.tickUncut(effect.uncut)}</Tick>}
      </div>
    </div>
  );
}

export function Interrupted({ job, known, acts, news }: {
  job: Job; known: SheetOfJob; acts: Acts; news: ComponentChildren;
}) {
  const ledger = useLedger(job, true);
  const ways = useWays(job);
  const resumes = ways.filter((way) => way.action === 'resume-from');
  const canKeep = resumes.some((way) => way.body.registration === 'kept');
  const firstDoubt = ledger?.in_doubt[0]?.[0] ?? ledger?.not_sent[0]?.[0] ?? 0;
  const [chosen, setChosen] = useState<Kind | null>(null);
  const [picked, setPicked] = useState<number | null>(null);
  const [registration, setRegistration] = useState<Registration | null>(null);
  const [twice, setTwice] = useState(false);
  const [uncut, setUncut] = useState(false);
  const stroke = picked ?? firstDoubt;
  const start = ledger ? startNear(ledger, stroke) : stroke;
  const effect = ledger ? consequence(ledger, start) : null;
  const [sent, setSent] = useState<number | null>(null);
  const fates = useMemo(() => (!ledger ? null : sent === null ? fatesOf(ledger) : fatesAfter(ledger, sent)), [ledger, sent]);
  const placed: Registration | null = registration ?? (canKeep ? null : 're-registered');
  useEffect(() => { setTwice(false); setUncut(false); }, [start, registration]);
  useEffect(() => { setChosen(null); setPicked(null); setRegistration(null); setSent(null); }, [job.rev]);

  const can = (action: string): boolean => job.actions.includes(action);
  const total = ledger ? strokesIn(ledger.certain) + strokesIn(ledger.in_doubt) + strokesIn(ledger.not_sent) : 0;
  const unsent = ledger ? strokesIn(ledger.not_sent) : 0;
  const lens = known.strokes ? strokeWords(known.strokes, stroke) : say.stroke;
  const startWhat = known.strokes ? strokeWords(known.strokes, start) : say.stroke;
  const risksTaken = effect !== null && (effect.twice === 0 || twice) && (effect.uncut === 0 || uncut) && placed !== null;
  const ready = chosen !== null && (chosen !== 'go-on' || risksTaken);

  const go = (): void => {
    const sheet = { sheet: job.sheet };
    if (chosen === 'new') acts.run('retry-sheet', sheet);
    else if (chosen === 'whole') acts.run('confirm-result', { ...sheet, good: true });
    else if (chosen === 'not-good') acts.run('confirm-result', { ...sheet, good: false });
    else if (chosen === 'skip') acts.run('skip-sheet', sheet);
    else if (chosen === 'give-up') acts.run('cancel', {});
    else if (chosen === 'go-on' && effect && placed) {
      acts.run('resume-from', {
        from_path: effect.from, registration: placed,
        ...(effect.twice > 0 ? { i_accept_double_cut: true } : {}),
        ...(effect.uncut > 0 ? { skip_in_doubt: true } : {}),
      });
    }
  };

  const step = (by: number): void => setPicked(Math.max(0, Math.min(total - 1, stroke + by)));
  return (
    <>
      <section class="machine-sheet">
        <SheetPicture job={job} known={known} fates={fates} marked={ledger && sent === null ? stroke : null} lens onPick={setPicked}
          label={say.lens(lens, stroke + 1, total)} />
        <div class="lens-line">
          <strong role="status">{lens}</strong>
          <span class="row">
            <Button onClick={() => step(-1)} label={say.previous}>‹</Button>
            <Button onClick={() => step(1)} label={say.next}>›</Button>
            <Button onClick={() => setPicked(null)}>{say.first}</Button>
          </span>
        </div>
        {ledger && known.strokes && strokesSent(ledger) > 0 && <Replay strokes={known.strokes} sent={strokesSent(ledger)} onSent={setSent} />}
      </section>
      <section class="machine-act">
        {news}
        <div role="alert"><h2 class="act-state act-alarm">{say.title}</h2></div>
        <p class="act-next">{say.look}</p>
        {ledger ? <Counts ledger={ledger} job={job} /> : <p class="muted">{words.loading}</p>}
        {!may('operator') ? <p class="muted">{words.machine.mayNot}</p> : ledger && (
          <fieldset class="ways" disabled={acts.off}>
            <legend>{say.choose}</legend>
            {can('retry-sheet') && (
              <Option kind="new" chosen={chosen} onChoose={setChosen} title={say.newSheet}>{say.newSheetWhat(total)}</Option>
            )}
            {can('resume-from') && resumes.length > 0 && (
              <Option kind="go-on" chosen={chosen} onChoose={setChosen} title={say.goOn}>{say.goOnWhat}</Option>
            )}
            {chosen === 'go-on' && effect && (
              <GoOn what={startWhat} effect={effect} registration={placed ?? ('' as Registration)} onRegistration={setRegistration}
                canKeep={canKeep} twice={twice} onTwice={setTwice} uncut={uncut} onUncut={setUncut} />
            )}
            {can('confirm-result') && (
              <Option kind="whole" chosen={chosen} onChoose={setChosen} title={say.whole} disabled={unsent > 0}>
                {unsent > 0 ? say.wholeNot(unsent) : say.wholeWhat}
              </Option>
            )}
            {can('confirm-result') && job.attention?.kind === 'confirm_result' && (
              <Option kind="not-good" chosen={chosen} onChoose={setChosen} title={say.notGood}>{say.notGoodWhat}</Option>
            )}
            {can('skip-sheet') && job.sheets_total > 1 && (
              <Option kind="skip" chosen={chosen} onChoose={setChosen} title={say.skip}>{say.skipWhat}</Option>
            )}
            {can('cancel') && (
              <Option kind="give-up" chosen={chosen} onChoose={setChosen} title={say.giveUp}>{say.giveUpWhat}</Option>
            )}
            <div class="act-right stack">
              <Button kind="primary" big disabled={acts.off || !ready} onClick={go}>{say.go}</Button>
              <span class="muted">{chosen === null ? say.chooseFirst : ready ? say.noneStarts : say.tickFirst}</span>
            </div>
          </fieldset>
        )}
      </section>
    </>
  );
}

