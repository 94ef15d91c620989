// SPDX-License-Identifier: MIT
// Sheets: what will be cut, sheet by sheet, played back from the plan's own strokes.
import { effect, useSignal, type Signal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { useAgain } from './again';
import type { Plan } from './model';
import { cutters, kNone, machineTitle, materialTitle, paperTitle, readMachines, readMaterials } from './outfit';
import { Button, Choice, LinkButton, Loading, Note, Trouble, useAsking } from './parts';
import { atDevice, foldOf } from './route';
import { act, isProblem, read, readBlob, saveAs, type ServerProblem } from './server';
import { endOf, SheetView, strokesAt, strokeWords, timeColour, type Strokes } from './sheet_view';
import { can, devices, may, stale } from './store';
import { tabStore } from './tab_store';
import { clockTime, integer, metres, size, timeRange, withoutTicks, words as everyWords } from './words';
import { designWords } from './words_design';

const words = designWords.sheets;
const kSpeeds = [1, 2, 5, 10, 20, 50];

/** The parts that a plan can tell beside those of its description. */
type WholePlan = Plan & { pieces?: number; seams?: unknown[] };

/** Reads the plan until it is planned or failed. */
export function usePlan(id: string): { plan: WholePlan | null; problem: ServerProblem | null } {
  const plan = useSignal<WholePlan | null>(null);
  const problem = useSignal<ServerProblem | null>(null);
  useEffect(() => {
    const abort = new AbortController();
    let wait_ms = 150;
    const again = async (): Promise<void> => {
      try {
        for (;;) {
          plan.value = await read<WholePlan>(`/v1/plans/${encodeURIComponent(id)}`, { signal: abort.signal });
          if (plan.value.state !== 'pending' || abort.signal.aborted) return;
          await new Promise((done) => setTimeout(done, wait_ms));
          wait_ms = Math.min(2000, wait_ms * 1.5);
        }
      } catch (error) {
        if (!abort.signal.aborted && isProblem(error)) problem.value = error;
      }
    };
    plan.value = null;
    problem.value = null;
    void again();
    return () => abort.abort();
  }, [id, useAgain(problem.value)]);
  return { plan: plan.value, problem: problem.value };
}

const strokesOf = new Map<string, Promise<Strokes>>();

/** The strokes of a sheet; plans never change, so they are read once. Throws ServerProblem. */
export function readStrokes(plan: string, sheet: number): Promise<Strokes> {
  const path = `/v1/plans/${encodeURIComponent(plan)}/sheets/${sheet}/strokes`;
  const known = strokesOf.get(path);
  if (known) return known;
  const made = read<Strokes>(path);
  strokesOf.set(path, made);
  made.catch(() => strokesOf.delete(path));
  if (strokesOf.size > 24) strokesOf.delete(strokesOf.keys().next().value as string);
  return made;
}

function Playback({ strokes, time, speed, travel, byTime, view }: {
  strokes: Strokes; time: Signal<number | null>; speed: Signal<number>; travel: Signal<boolean>; byTime: Signal<boolean>; view: SheetView | null;
}) {
  const playing = useSignal(false);
  const frame = useRef(0);
  const range = useRef<HTMLInputElement>(null);
  const all = endOf(strokes);
  const stop = (): void => {
    cancelAnimationFrame(frame.current);
    playing.value = false;
  };
  useEffect(() => stop, [strokes]);
  const play = (): void => {
    if (playing.value) {
      stop();
      return;
    }
    playing.value = true;
    let last = performance.now();
    if (time.value === null || time.value >= all) time.value = 0;
    const tick = (now: number): void => {
      const next = (time.value ?? 0) + ((now - last) / 1000) * speed.value;
      last = now;
      time.value = Math.min(all, next);
      if (next < all) frame.current = requestAnimationFrame(tick);
      else stop();
    };
    frame.current = requestAnimationFrame(tick);
  };
  const at = time.value ?? all;
  useEffect(() => { range.current?.style.setProperty('--at', `${all > 0 ? (at / all) * 100 : 0}%`); });
  const begun = strokesAt(strokes, at).begun;
  const what = begun === 0 ? words.nothingYet : strokeWords(strokes, begun - 1);
  return (
    <div class="playback">
      <button type="button" class="button button-plain" aria-pressed={playing.value} onClick={play}>{playing.value ? words.stop : words.play}</button>
      <input ref={range} type="range" min="0" max={all} step="any" value={at} aria-label={words.at} aria-valuetext={words.textAt(clockTime(at), clockTime(all), what)}
        onInput={(event) => { stop(); time.value = Number(event.currentTarget.value); }} />
      <output class="figure">{clockTime(at)} / {clockTime(all)}</output>
      <label class="visually-hidden" for="speed">{words.speed}</label>
      <select id="speed" value={String(speed.value)} onChange={(event) => { speed.value = Number(event.currentTarget.value); }}>
        {kSpeeds.map((one) => <option key={one} value={String(one)} selected={one === speed.value}>{words.times(one)}</option>)}
      </select>
      <label class={travel.value ? 'segment segment-single segment-on' : 'segment segment-single'}>
        <input type="checkbox" class="visually-hidden" checked={travel.value} onChange={(event) => { travel.value = event.currentTarget.checked; }} />{words.travel}
      </label>
      <label class={byTime.value ? 'segment segment-single segment-on' : 'segment segment-single'}>
        <input type="checkbox" class="visually-hidden" checked={byTime.value} onChange={(event) => { byTime.value = event.currentTarget.checked; }} />{words.byTime}
      </label>
      {byTime.value && (
        <span class="legend-what">{words.early} <svg class="time-ramp" viewBox="0 0 12 1" preserveAspectRatio="none" aria-hidden="true">
          {Array.from({ length: 12 }, (_, i) => <rect key={i} x={i} y="0" width="1.05" height="1" fill={timeColour(i / 11)} />)}
        </svg> {words.late}</span>
      )}
      <button type="button" class="segment segment-single" onClick={() => { stop(); time.value = null; view?.fit(); }}>{words.whole}</button>
      <button type="button" class="segment segment-single" onClick={() => view?.trueSize()}>{words.trueSize}</button>
    </div>
  );
}

function SheetStage({ plan, sheet, onHover }: { plan: string; sheet: number; onHover: (text: string) => void }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const strokes = useSignal<Strokes | null>(null);
  const problem = useSignal<ServerProblem | null>(null);
  const time = useSignal<number | null>(null);
  const speed = useSignal(10);
  const travel = useSignal(false);
  const byTime = useSignal(false);
  const view = useSignal<SheetView | null>(null);
  useEffect(() => {
    if (!canvas.current) return undefined;
    const made = new SheetView(canvas.current);
    view.value = made;
    made.onHover = (stroke) => {
      made.setMarked(stroke);
      onHover(stroke !== null && strokes.peek() ? strokeWords(strokes.peek() as Strokes, stroke) : '');
    };
    made.onPick = (stroke) => made.setLens(stroke);
    const stops = [
      effect(() => made.setStrokes(strokes.value)),
      effect(() => made.setTime(time.value)),
      effect(() => made.setOptions({ travel: travel.value, byTime: byTime.value })),
    ];
    return () => {
      for (const stop of stops) stop();
      made.dispose();
    };
  }, []);
  useEffect(() => {
    let wanted = true;
    time.value = null;
    strokes.value = null;
    problem.value = null;
    view.peek()?.setLens(null);
    view.peek()?.setMarked(null);
    readStrokes(plan, sheet).then((read_) => { if (wanted) strokes.value = read_; }, (error: unknown) => { if (wanted && isProblem(error)) problem.value = error; });
    return () => { wanted = false; };
  }, [plan, sheet, useAgain(problem.value)]);
  return (
    <div>
      {problem.value && <Trouble problem={problem.value} />}
      <canvas ref={canvas} class="plan-canvas" role="img" tabIndex={0} aria-label={strokes.value && view.value ? view.value.describe() : words.picture(sheet)}
        data-strokes={strokes.value ? strokes.value.stroke.points.length : ''} />
      {strokes.value && <Playback strokes={strokes.value} time={time} speed={speed} travel={travel} byTime={byTime} view={view.value} />}
    </div>
  );
}

interface Wanted { copies: number; device: string | null }

/** What was asked for with "Cut this" for this plan. */
function wantedFor(plan: string): Wanted {
  try {
    const kept: unknown = JSON.parse(tabStore.getItem(`popcut.cut.${plan}`) ?? 'null');
    if (typeof kept === 'object' && kept !== null) {
      const { copies, device } = kept as Partial<Wanted>;
      return { copies: typeof copies === 'number' ? copies : 1, device: typeof device === 'string' ? device : null };
    }
  } catch {
    // what is kept is only a convenience
  }
  return { copies: 1, device: null };
}

/** The design that a plan was made of: its kind, and its name on one line. Both are empty until they are known. */
function useDesignOf(design: string | null | undefined): { name: string; kind: string } {
  const known = useSignal({ name: '', kind: '' });
  useEffect(() => {
    known.value = { name: '', kind: '' };
    if (!design) return undefined;
    const stop = new AbortController();
    read<{ name?: string | null; kind?: string }>(`/v1/designs/${encodeURIComponent(design)}`, { signal: stop.signal }).then((one) => {
      known.value = { name: [...(one.name ?? '').replace(/\s+/g, ' ').trim()].slice(0, 120).join(''), kind: one.kind ?? '' };
    }, () => undefined);
    return () => stop.abort();
  }, [design]);
  return known.value;
}

/** What is printed on a sheet before it is cut. popcutd draws it when it is asked for. */
function PrintFirst({ plan, sheet, paper, marks }: { plan: string; sheet: number; paper: string; marks: boolean }) {
  const { busy, problem, run } = useAsking();
  useEffect(() => { problem.value = null; }, [sheet]);
  const get = (clay = false): Promise<void> => run(async () => {
    saveAs(await readBlob(`/v1/plans/${encodeURIComponent(plan)}/sheets/${sheet}/artwork.pdf${clay ? '?clay=true' : ''}`), `print-${sheet}.pdf`);
  });
  return (
    <section aria-label={words.print} class="note">
      <h2>{words.print}</h2>
      <p class="small">{words.printWhat(paper, marks)}</p>
      {problem.value?.status === 422
        ? (
          <div class="note note-amber" role="alert">
            <p>{words.noColours}</p>
            <Button onClick={() => void get(true)} disabled={busy.value}>{designWords.standing.clay}</Button>
          </div>
        )
        : problem.value && <Trouble problem={problem.value} onClose={() => { problem.value = null; }} />}
      <Button onClick={() => void get()} disabled={busy.value || stale.value}>{busy.value ? words.drawingPage : words.page}</Button>
    </section>
  );
}

function QueueIt({ plan, name }: { plan: WholePlan; name: string }) {
  const wanted = useRef(wantedFor(plan.id));
  const copies = useSignal(wanted.current.copies);
  const device = useSignal(wanted.current.device ?? '');
  const done = useSignal(false);
  const { busy, problem, run } = useAsking();
  const queue = (): Promise<void> => run(async () => {
    const body: Record<string, unknown> = { plan: plan.id, copies: copies.value };
    if (name) body.name = name;
    if (device.value) body.device = device.value;
    await act('/v1/jobs', undefined, body);
    done.value = true;
  });
  if (done.value) {
    const at = device.value || (devices.value.size === 1 ? cutters.value[0]![0] : '');
    return (
      <Note kind="good"><p role="status">{words.queued}</p>
        {at && may('operator') && <LinkButton href={atDevice(at)} kind="primary">{words.toMachine}</LinkButton>}
        <LinkButton href="#/" kind={at ? 'plain' : 'primary'}>{words.toNow}</LinkButton></Note>
    );
  }
  return (
    <section aria-label={words.queue}>
      {problem.value && <Trouble problem={problem.value} />}
      <Choice label={designWords.cut.cutter} value={devices.value.size === 1 ? cutters.value[0]![0] : device.value}
        options={devices.value.size > 1 ? [['', words.anyCutter], ...cutters.value] : cutters.value} onChange={(value) => { device.value = value; }} />
      <label class="field"><span>{words.copies}</span>
        <input type="number" min="1" max="1000" value={copies.value}
          onChange={(event) => { copies.value = Math.max(1, Math.min(1000, Math.round(Number(event.currentTarget.value)) || 1)); }} />
      </label>
      <Button kind="primary" big onClick={() => void queue()} disabled={busy.value || stale.value || !may('submitter')}>{words.queue}</Button>
    </section>
  );
}

/** How large what is cut on a sheet is; '' until that is known. */
function useDrawn(plan: string, sheet: number, planned: boolean): string {
  const drawn = useSignal('');
  useEffect(() => {
    drawn.value = '';
    let wanted = planned;
    if (planned) readStrokes(plan, sheet).then(({ drawing_mm: [, , w, h] }) => { if (wanted) drawn.value = size(w, h); }, () => undefined);
    return () => { wanted = false; };
  }, [plan, sheet, planned]);
  return drawn.value;
}

function Fact({ name, children }: { name: string; children: string }) {
  return <div class="figure-row"><dt>{name}</dt><dd class="figure">{children}</dd></div>;
}

/** `#/sheets/PLAN` */
export default function Sheets({ rest: id }: { rest: string }) {
  const { plan, problem } = usePlan(id);
  const sheet = useSignal(1);
  const under = useSignal('');
  const { name, kind } = useDesignOf(plan?.design);
  const unsaved = useSignal<ServerProblem | null>(null);
  const drawn = useDrawn(id, sheet.value, plan?.state === 'planned');
  useEffect(() => { void Promise.all([readMachines(), readMaterials()]); }, []);
  if (problem) return <Trouble problem={problem} />;
  if (!plan) return <Loading />;
  if (plan.state === 'failed') return <div class="note note-bad" role="alert"><p><strong>{words.failed}</strong></p><p class="server-words">{withoutTicks(plan.error ?? '')}</p>
    {plan.design && <p><LinkButton href={`#/design/${plan.design}`}>{words.toDesign}</LinkButton></p>}</div>;
  if (plan.state === 'pending') return <div class="loading" role="status">{words.planning}</div>;
  const total = plan.sheets_total;
  const shown = plan.sheets.find((one) => one.sheet === sheet.value) ?? plan.sheets[sheet.value - 1];
  const go = (k: number): void => { sheet.value = Math.max(1, Math.min(total, k)); };
  const save = async (): Promise<void> => {
    unsaved.value = null;
    try {
      saveAs(await readBlob(`/v1/plans/${encodeURIComponent(id)}/sheets/${sheet.value}.svg`), `sheets-${sheet.value}.svg`);
    } catch (error) {
      if (!isProblem(error)) throw error;
      unsaved.value = error;
    }
  };
  return (
    <div class="sheets">
      <div class="row row-between">
        <h1>{words.title}{name && <span class="muted">, {name}</span>}</h1>
        <div class="row">
          <Button kind="quiet" onClick={() => void save()}>{words.drawing}</Button>
          {kind === 'spec' && <LinkButton kind="quiet" href={foldOf(plan.design)}>{words.fold}</LinkButton>}
          {(total > 1 || kind !== 'spec') && <LinkButton kind="quiet" href={`#/glue/${id}`}>{total > 1 ? words.glue : words.fold}</LinkButton>}
        </div>
      </div>
      {unsaved.value && <Trouble problem={unsaved.value} onClose={() => { unsaved.value = null; }} />}
      {total > 1 && (
        <div class="sheet-tabs" role="tablist" aria-label={words.title} onKeyDown={(event) => {
          if (event.key === 'ArrowRight') go(sheet.value + 1);
          else if (event.key === 'ArrowLeft') go(sheet.value - 1);
          else return;
          event.preventDefault();
        }}>
          {Array.from({ length: Math.min(total, 60) }, (_, i) => (
            <button key={i} type="button" role="tab" aria-selected={sheet.value === i + 1} tabIndex={sheet.value === i + 1 ? 0 : -1}
              class={sheet.value === i + 1 ? 'segment segment-single segment-on' : 'segment segment-single'} onClick={() => go(i + 1)}>{words.sheet(i + 1, total)}</button>
          ))}
        </div>
      )}
      <div class="sheets-main">
        <SheetStage plan={id} sheet={sheet.value} onHover={(text) => { under.value = text; }} />
        <div class="sheets-side">
          {plan.warnings.length > 0 && (
            <section aria-label={words.warnings} class="note note-amber">
              <h2>{words.warnings}</h2>
              <ul class="plain-list server-words">{plan.warnings.slice(0, 30).map((one, i) => <li key={i}>{withoutTicks(one.message)}</li>)}</ul>
            </section>
          )}
          {kind === 'spec' && shown && (shown.side === 'printed' || !can('devices')) && <PrintFirst plan={id} sheet={sheet.value} paper={paperTitle(shown)} marks={shown.side === 'printed'} />}
          {plan.machine === kNone ? <p class="note">{words.byHand}</p> : can('queue') && may('submitter') && <QueueIt plan={plan} name={name} />}
          <section aria-label={words.sheet(sheet.value, total)}>
            <h2>{words.sheet(sheet.value, total)}</h2>
            <dl class="facts">
              {shown && <Fact name={words.time}>{timeRange(shown.seconds_range)}</Fact>}
              {shown && <Fact name={words.strokes}>{integer(shown.paths)}</Fact>}
              {shown && <Fact name={words.toCut}>{metres(shown.cut_mm + shown.fold_mm)}</Fact>}
              {drawn && <Fact name={words.drawn}>{drawn}</Fact>}
              {shown && <Fact name={designWords.figures.sheet}>{paperTitle(shown)}</Fact>}
              {plan.material && <Fact name={words.material}>{materialTitle(plan.material)}</Fact>}
              {plan.machine && <Fact name={words.machine}>{machineTitle(plan.machine)}</Fact>}
            </dl>
            {plan.handwork && <p>{everyWords.byHand(plan.handwork.folds, plan.handwork.shortest_fold_mm, plan.handwork.fold_s, plan.handwork.label)}</p>}
            {total > 1 && <p class="small muted">{words.letters}</p>}
            <p class="muted figure" aria-live="polite">{under.value || ' '}</p>
          </section>
        </div>
      </div>
    </div>
  );
}
