// At the machine: one job, one next act.
import type { ComponentChildren } from 'preact';
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks';
import { HoldButton } from './hold';
import { Interrupted } from './interrupted';
import { fatesOf } from './ledger';
import type { Device, Job, Warning } from './model';
import { fits, isElsewhere, remaining, shareCut } from './now';
import { Button, Choice, Dialog, LinkButton, Loading, Meter, Note, Tick, Trouble } from './parts';
import { beside } from './preferences';
import { atDevice, glueOf, sheetsOf } from './route';
import { act, isProblem, read, type ServerProblem } from './server';
import { SheetPicture, useLedger, useSheet, type SheetOfJob } from './sheet_picture';
import type { Fates } from './sheet_view';
import {
  devices, hasEnded, isPausing, jobs, lastChange, loaded, localTime, may, now, operatorOf, progressOf,
  queueOrder, readJob, removedBy, stale, takeJob,
} from './store';
import { clockTime, count, duration, percent, size, timeRange, withoutTicks, words } from './words';

const say = words.machine;
const nameOf = (job: Job): string => job.name ?? words.unnamed;

/** The jobs that can be seen to at `device`, the most urgent first. */
function jobsAt(device: Device): Job[] {
  const rank: Record<string, number> = { cutting: 0, paused: 0, armed: 1, interrupted: 2, ready: 3 };
  const place = new Map(queueOrder.value.map((id, at) => [id, at]));
  const order = (job: Job): number => place.get(job.id) ?? 1e9;
  return [...jobs.value.values()]
    .filter((job) => job.state in rank && fits(job, device) && !(job.held && job.state === 'ready'))
    .sort((a, b) => rank[a.state]! - rank[b.state]! || order(a) - order(b) || a.id.localeCompare(b.id));
}

/** What happened instead of an act that came too late. */
function Changed({ job, shown, problem, onClose }: {
  job: Job; shown: number; problem: ServerProblem; onClose: () => void;
}) {
  const change = lastChange.value.get(job.id);
  const recent = change && job.rev !== shown && now.value - change.at < 600_000 ? change : null;
  return (
    <div class="note note-amber" role="alert">
      <p><strong>{words.changed.nothingDone}</strong></p>
      <p>{recent ? words.changed.by(recent.who ?? words.changed.someone,
        words.changed.did[recent.state] ?? words.changed.changedIt, duration(Math.max(1, (now.value - recent.at) / 1000)))
        : problem.kind === 'stale' ? words.changed.itChanged : words.problems[problem.kind] ?? ''} {words.changed.meanwhile(words.states[job.state] ?? job.state)}</p>
      {problem.kind !== 'stale' && problem.detail && <p class="server-words">{problem.detail}</p>}
      <Button kind="quiet" onClick={onClose}>{words.close}</Button>
    </div>
  );
}

/** Acts on `job` as it is shown. */
export interface Acts {
  busy: boolean;
  off: boolean;                                      // nothing may be done now: busy, or what is shown is old
  run: (action: string, body: unknown) => void;
}

function useActs(job: Job): Acts & { problem: ServerProblem | null; shown: number; clear: () => void } {
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const shown = useRef(job.rev);
  const run = (action: string, body: unknown): void => {
    shown.current = job.rev;
    setBusy(true);
    setProblem(null);
    act<Job>(`/v1/jobs/${job.id}/actions/${action}`, job.rev, body).then(takeJob, async (error) => {
      if (!isProblem(error)) throw error;
      if (error.status === 412 || error.status === 409 || error.status === 404) await readJob(job.id);
      setProblem(error);
    }).finally(() => setBusy(false));
  };
  return { busy, off: busy || stale.value, run, problem, shown: shown.current, clear: () => setProblem(null) };
}

interface MaterialValues { title?: string; autoblade_depth?: number; cut?: { force_gf?: number } }

const materials = new Map<string, Promise<MaterialValues | null>>();

/** The values of a material, read once. */
function useMaterial(name: string | null): MaterialValues | null {
  const [values, setValues] = useState<MaterialValues | null>(null);
  useEffect(() => {
    setValues(null);
    if (!name) return;
    let wanted = true;
    const known = materials.get(name) ?? read<{ material: MaterialValues | null }>(
      `/v1/materials/${encodeURIComponent(name)}`).then((answer) => answer.material);
    materials.set(name, known);
    known.then((one) => { if (wanted) setValues(one); }, () => materials.delete(name));
    return () => { wanted = false; };
  }, [name]);
  return values;
}

/** A screen that must not go dark while it shows what is armed or cut. */
function useWakeLock(wanted: boolean): void {
  useEffect(() => {
    if (!wanted || !('wakeLock' in navigator)) return;
    let lock: WakeLockSentinel | null = null;
    let over = false;
    const take = (): void => {
      if (document.visibilityState !== 'visible') return;
      navigator.wakeLock.request('screen').then((one) => {
        if (over) void one.release();
        else lock = one;
      }, () => undefined);
    };
    take();
    document.addEventListener('visibilitychange', take);
    return () => {
      over = true;
      document.removeEventListener('visibilitychange', take);
      void lock?.release().catch(() => undefined);
    };
  }, [wanted]);
}

function WarningText({ warning }: { warning: Warning }) {
  return <p class="server-words">{withoutTicks(warning.message)}</p>;
}

/** Warnings: those that may spoil the cut are accepted one by one. */
function Warnings({ job, accepted, onAccept }: {
  job: Job; accepted: ReadonlySet<string>; onAccept: (code: string, on: boolean) => void;
}) {
  const open = job.warnings.filter((one) => job.unaccepted_warnings.includes(one.code));
  const codes = [...new Set(job.unaccepted_warnings)];
  const others = job.warnings.filter((one) => !job.unaccepted_warnings.includes(one.code));
  return (
    <>
      {codes.length > 0 && (
        <Note kind="amber">
          <h3>{say.warnings}</h3>
          {codes.map((code) => (
            <div class="warning" key={code}>
              {open.filter((one) => one.code === code).map((one, at) => <WarningText key={at} warning={one} />)}
              <p><strong>{say.spoils}</strong></p>
              <Tick big checked={accepted.has(code)} onChange={(on) => onAccept(code, on)}>{say.accept}</Tick>
            </div>
          ))}
        </Note>
      )}
      {others.length > 0 && (
        <details class="hints"><summary>{say.hints} ({others.length})</summary>
          {others.map((one, at) => <WarningText key={at} warning={one} />)}</details>
      )}
    </>
  );
}

/** What lies where, in one word each. */
function tickTexts(job: Job, material: MaterialValues | null): [string, string, string] {
  const load = job.load;
  const name = material?.title ?? load?.material ?? job.material ?? '';
  const side = load?.side ? say.sides[load.side] ?? '' : '';
  const where = load?.mat ? say.onMat(load.mat) : load ? say.noMat(size(load.width_mm, load.length_mm)) : '';
  return [
    [say.tickMaterial(name, side), where].filter(Boolean).join(', '),
    load?.mat ? say.tickMat : say.tickSheet,
    material?.autoblade_depth !== undefined ? say.tickBlade(say.bladeDepth(String(material.autoblade_depth))) : say.tickBladeAny,
  ];
}

interface Preparation { ticks: boolean[]; accepted: ReadonlySet<string> }
const nothingPrepared: Preparation = { ticks: [false, false, false], accepted: new Set() };

/** Ready: load, tick three times, arm. The ticks are forgotten when the sheet, its blank or the job changes. */
function Ready({ job, acts, device, prepared, onPrepare, material }: {
  job: Job; acts: Acts; device: Device; prepared: Preparation; onPrepare: (next: Preparation) => void; material: MaterialValues | null;
}) {
  const texts = tickTexts(job, material);
  const stays = job.segment > 1;
  const mine = may('operator');
  return (
    <>
      <h2 class="act-state">{say.ready}</h2>
      <p class="act-next">{say.loadSheet(job.sheet ?? 1, job.sheets_total)}</p>
      {stays ? <p>{say.keepSheet}</p> : job.blank > 1 && <p>{say.blank(job.blank)}</p>}
      {job.attention?.kind === 'load_sheet' && stays && job.attention.text && <p class="server-words">{job.attention.text}</p>}
      <Warnings job={job} accepted={prepared.accepted} onAccept={(code, on) => {
        const accepted = new Set(prepared.accepted);
        if (on) accepted.add(code);
        else accepted.delete(code);
        onPrepare({ ...prepared, accepted });
      }} />
      {isElsewhere(device) ? null : mine ? (
        <div class="ticks-and-arm">
          <div class="ticks">
            {texts.map((text, at) => (
              <Tick key={at} big checked={prepared.ticks[at]!} disabled={acts.off} onChange={(on) => {
                onPrepare({ ...prepared, ticks: prepared.ticks.map((old, other) => (other === at ? on : old)) });
              }}>{text}</Tick>
            ))}
          </div>
          <ArmButton job={job} acts={acts} prepared={prepared} device={device} />
        </div>
      ) : <p class="muted">{say.mayNot}</p>}
    </>
  );
}

/** Arm: at the left, where START never is. */
function ArmButton({ job, acts, prepared, device }: { job: Job; acts: Acts; prepared: Preparation; device: Device }) {
  const [asks, setAsks] = useState(false);
  const ticked = prepared.ticks.every(Boolean);
  const warned = job.unaccepted_warnings.every((code) => prepared.accepted.has(code));
  const arm = (): void => acts.run('arm', {
    sheet: job.sheet, blank: job.blank, device: device.id,
    ...(job.unaccepted_warnings.length > 0 ? { accept_warnings: [...new Set(job.unaccepted_warnings)] } : {}),
  });
  if (!may('operator') || isElsewhere(device)) return null;
  const fault = device.state === 'fault' || device.state === 'absent' || device.state === 'offline' || !device.enabled;
  const off = acts.off || !ticked || !warned || fault;
  return (
    <div class="act-left">
      <Button kind="primary" big class="arm" disabled={off}
        onClick={() => (beside.value === device.id ? arm() : setAsks(true))}>{say.arm}</Button>
      <span class="muted">{fault ? say.afterFault : !ticked ? say.afterTicks : !warned ? say.afterWarnings : say.armWhat}</span>
      {asks && (
        <Dialog title={say.notBeside(device.title)} yes={say.notBesideGo} onNo={() => setAsks(false)}
          onYes={() => { setAsks(false); arm(); }}>
          <p>{say.notBesideWhat(device.title)}</p>
        </Dialog>
      )}
    </div>
  );
}

function Lapse({ job }: { job: Job }) {
  if (!job.armed_until) return <p class="muted">{say.lapsesSoon}</p>;
  const left_s = (localTime(job.armed_until) - now.value) / 1000;
  return <p class="lapse figure">{say.lapses(clockTime(left_s))}</p>;
}

function Armed({ job, acts, device }: { job: Job; acts: Acts; device: Device }) {
  return (
    <>
      <h2 class="act-state">{say.armed}</h2>
      <p class="act-next">{say.armedWhat}</p>
      <p>{say.armedBy(operatorOf(job) ?? words.nobody)}</p>
      <Lapse job={job} />
      {isElsewhere(device) ? null : may('operator') ? (
        <div class="act-right">
          <HoldButton key={job.rev} disabled={acts.off} onHeld={() => acts.run('start', { sheet: job.sheet })}
            question={{ title: say.startSure, text: say.startSureWhat(job.sheet ?? 1, job.sheets_total, device.title), yes: say.startGo }}>
            {acts.busy ? say.sending : <><span class="hold-small">{say.holdTo}</span>{say.start}</>}
          </HoldButton>
        </div>
      ) : <p class="muted">{say.mayNot}</p>}
    </>
  );
}

function Cutting({ job }: { job: Job }) {
  const live = progressOf.value.get(job.id);
  const done = live?.paths_done ?? job.progress.paths_done ?? job.progress.paths_certain;
  const all = live?.paths ?? job.progress.paths_total;
  const share = shareCut(job);
  const pausing = isPausing(job);
  const phase = live && live.phase !== 'cutting' ? words.phases[live.phase] : undefined;
  return (
    <>
      <h2 class="act-state">{pausing ? say.pausing : say.cutting}</h2>
      {pausing && <p class="act-next">{say.pausingWhat}</p>}
      <p class="big-figure figure" aria-hidden="true">{percent(share)}</p>
      <Meter share={share} label={nameOf(job)} />
      <p class="figure">{say.progress(done, all)}{phase ? ` · ${phase}` : ''}</p>
      <p class="act-next figure">{say.left(timeRange(remaining(job)))}</p>
      {!may('operator') && <p class="muted">{say.mayNotPause}</p>}
      <p class="muted small">{say.likely}</p>
    </>
  );
}

function Paused({ job, acts, device }: { job: Job; acts: Acts; device: Device }) {
  const share = shareCut(job);
  return (
    <>
      <h2 class="act-state">{say.paused}</h2>
      <p class="act-next">{say.pausedWhat}</p>
      <Meter share={share} label={nameOf(job)} />
      <p class="figure">{percent(share)} · {say.left(timeRange(remaining(job)))}</p>
      {isElsewhere(device) ? null : may('operator') ? (
        <div class="act-right">
          <HoldButton key={job.rev} disabled={acts.off} onHeld={() => acts.run('resume', {})}
            question={{ title: say.goOnSure, text: say.goOnSureWhat(device.title), yes: say.goOnGo }}>
            {acts.busy ? say.sending : <><span class="hold-small">{say.holdTo}</span>{say.goOn}</>}
          </HoldButton>
        </div>
      ) : <p class="muted">{say.mayNot}</p>}
    </>
  );
}

type Question = 'cancel' | 'end' | 'skip' | null;

/** The acts that end something: each asks, elsewhere on the screen. */
function Ending({ job, acts, device }: { job: Job; acts: Acts; device: Device }) {
  const [asks, setAsks] = useState<Question>(null);
  const can = (action: string): boolean => job.actions.includes(action) && may('operator');
  const texts = {
    cancel: [say.cancelJobSure(nameOf(job)), say.cancelJobWhat, say.cancelJobGo],
    end: [say.endJobSure(nameOf(job)), say.endJobWhat, say.endJobGo],
    skip: [say.skipSheetSure(job.sheet ?? 1), say.skipSheetWhat, say.skipSheetGo],
  } as const;
  const go = (question: Question): void => {
    setAsks(null);
    if (question === 'skip') acts.run('skip-sheet', { sheet: job.sheet });
    else acts.run('cancel', {});
  };
  const paused = job.state === 'paused' || job.state === 'cutting';
  return (
    <div class="danger-line">
      <strong>{say.danger}</strong>
      <span class="danger-acts">
        {job.state !== 'cutting' && job.state !== 'paused' && job.state !== 'armed' && <TestCut device={device} material={job.load?.material ?? null} />}
        {can('skip-sheet') && job.state !== 'interrupted' && (
          <Button kind="quiet" disabled={acts.off} onClick={() => setAsks('skip')}>{say.skipSheet}</Button>
        )}
        {can('cancel') && (
          <Button kind="quiet" disabled={acts.off} onClick={() => setAsks(paused ? 'end' : 'cancel')}>
            {paused ? say.endJob : say.cancelJob}
          </Button>
        )}
      </span>
      {asks && (
        <Dialog title={texts[asks][0]} yes={texts[asks][2]} kind="danger" onNo={() => setAsks(null)} onYes={() => go(asks)}>
          <p>{texts[asks][1]}</p>
        </Dialog>
      )}
    </div>
  );
}

function TestCut({ device, material }: { device: Device; material: string | null }) {
  const [open, setOpen] = useState(false);
  const [names, setNames] = useState<string[]>([]);
  const [chosen, setChosen] = useState(material ?? '');
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  useEffect(() => {
    if (!open) return;
    read<{ items: { id: string }[] }>('/v1/materials').then(({ items }) => {
      const all = items.map((one) => one.id);
      setNames(all);
      setChosen((old) => old || device.materials[0] || all[0] || '');
    }, () => undefined);
  }, [open]);
  if (!may('operator')) return null;
  const queue = (): void => {
    setProblem(null);
    act(`/v1/devices/${encodeURIComponent(device.id)}/actions/test-cut`, device.rev, { material: chosen })
      .then(() => setOpen(false), (error) => { if (isProblem(error)) setProblem(error); });
  };
  return (
    <>
      <Button kind="quiet" disabled={stale.value} onClick={() => setOpen(true)}>{say.testCut}</Button>
      {open && (
        <Dialog title={say.testCut} yes={say.testCutGo} onNo={() => setOpen(false)} onYes={queue} busy={chosen === ''}>
          <p>{say.testCutWhat}</p>
          <Choice label={say.testCutMaterial} value={chosen} onChange={setChosen}
            options={(names.length > 0 ? names : [chosen]).map((name): [string, string] => [name, name])} />
          {problem && <Trouble problem={problem} />}
        </Dialog>
      )}
    </>
  );
}

/** Where a cutter of another popcutd is, and the way there: an address of another node may be anything. */
function Elsewhere({ device }: { device: Device }) {
  if (!isElsewhere(device)) return null;
  const node = device.node ?? '';
  return (
    <Note>
      <p><strong>{say.elsewhere(device.title, node)}</strong></p>
      <p>{say.elsewhereWhat}</p>
      {/^https?:\/\//i.test(device.node_url ?? '') && (
        <LinkButton href={`${device.node_url!.replace(/\/+$/, '')}/${atDevice(device.id)}`}>{say.goThere(node)}</LinkButton>
      )}
    </Note>
  );
}

/** A cutter that needs a person at its panel. */
function Fault({ device }: { device: Device }) {
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const [busy, setBusy] = useState(false);
  if (device.state !== 'fault' && device.state !== 'attention' && device.state !== 'absent' && device.state !== 'offline') return null;
  const reset = (): void => {
    setBusy(true);
    setProblem(null);
    act(`/v1/devices/${encodeURIComponent(device.id)}/actions/reset`, device.rev, {})
      .catch((error) => { if (isProblem(error)) setProblem(error); }).finally(() => setBusy(false));
  };
  return (
    <Note kind="amber">
      <p><strong>{device.state === 'absent' || device.state === 'offline' ? words.attentions.device_absent(device.title) : say.fault}</strong></p>
      {device.reasons.length > 0 && <p class="server-words">{device.reasons.join('\n')}</p>}
      {device.state === 'fault' && may('operator') && <Button big disabled={busy || stale.value} onClick={reset}>{say.reset}</Button>}
      {problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}
    </Note>
  );
}

function Caption({ job, known }: { job: Job; known: SheetOfJob }) {
  const strokes = known.strokes;
  const plan = known.sheet?.plan;
  return (
    <p class="sheet-caption">
      {strokes && <span>{say.trueSize(size(strokes.drawing_mm[2], strokes.drawing_mm[3]),
        String(Math.round(strokes.drawing_mm[0])), String(Math.round(strokes.drawing_mm[1])))}</span>}
      {plan && <span class="figure">{timeRange(plan.seconds_range)}</span>}
      {plan && <span>{count(plan.paths, 'stroke', 'strokes')}</span>}
      {job.plan && <a href={sheetsOf(job.plan)}>{say.order}</a>}
    </p>
  );
}

/** Strokes that are certainly and probably cut, for a picture that grows. */
function useFates(job: Job): Fates | null {
  const wanted = job.state === 'paused' || (job.state === 'ready' && job.segment > 1);
  const ledger = useLedger(job, wanted);
  const live = progressOf.value.get(job.id);
  if (job.state === 'cutting') {
    const done = live?.paths_done ?? job.progress.paths_done ?? 0;
    const certain = live?.paths_certain ?? job.progress.paths_certain;
    return { certain: certain > 0 ? [[0, certain]] : [], doubt: [], done };
  }
  return ledger && wanted ? fatesOf(ledger) : null;
}

function AtJob({ job, device, others, onChoose }: {
  job: Job; device: Device; others: Job[]; onChoose: (id: string) => void;
}) {
  const acts = useActs(job);
  const known = useSheet(job);
  const fates = useFates(job);
  const material = useMaterial(job.load?.material ?? job.material);
  const loadedSheet = `${job.sheet} ${job.blank} ${job.segment}`;
  const [preparedFor, setPreparedFor] = useState<{ sheet: string; what: Preparation }>({ sheet: '', what: nothingPrepared });
  const prepared = preparedFor.sheet === loadedSheet ? preparedFor.what : nothingPrepared;
  const setPrepared = (what: Preparation): void => setPreparedFor({ sheet: loadedSheet, what });
  useEffect(() => { if (job.state !== 'ready') setPrepared(nothingPrepared); }, [job.state]);
  useWakeLock(job.state === 'armed' || job.state === 'cutting');
  const act = useRef<HTMLElement>(null);
  useLayoutEffect(() => {   // Arm is below its ticks: what comes next begins above
    if (job.state !== 'ready' && (act.current?.getBoundingClientRect().top ?? 0) < 0) scrollTo(0, 0);
  }, [job.state]);

  const title = words.now.sheetOf(job.sheet ?? 1, job.sheets_total);
  const label = say.picture(job.sheet ?? 1, nameOf(job), known.strokes
    ? size(known.strokes.drawing_mm[2], known.strokes.drawing_mm[3]) : '');
  const head = (
    <header class="machine-head">
      <a class="back" href="#/">‹ {words.views.now}</a>
      <h1>{nameOf(job)}<span class="muted">, {title}</span></h1>
      <span class="muted">{device.title}</span>
      {others.length > 0 && job.state !== 'cutting' && job.state !== 'paused' && (
        <label class="other-jobs"><span class="visually-hidden">{say.otherJobs}</span>
          <select value={job.id} onChange={(event) => onChoose(event.currentTarget.value)}>
            {[job, ...others].map((one) => <option key={one.id} value={one.id} selected={one.id === job.id}>{nameOf(one)}</option>)}
          </select></label>
      )}
    </header>
  );
  const news = (
    <>
      <Elsewhere device={device} />
      <Fault device={device} />
      {acts.problem && (acts.problem.status === 412 || acts.problem.status === 409
        ? <Changed job={job} shown={acts.shown} problem={acts.problem} onClose={acts.clear} />
        : <Trouble problem={acts.problem} onClose={acts.clear} />)}
    </>
  );
  if (job.state === 'interrupted') {
    return (
      <div class="machine">
        {head}
        <Interrupted job={job} known={known} acts={acts} news={news} />
        <Ending job={job} acts={acts} device={device} />
      </div>
    );
  }
  return (
    <div class={`machine machine-${job.state}`}>
      {head}
      <section class="machine-sheet">
        <SheetPicture job={job} known={known} fates={fates} label={label} />
        <Caption job={job} known={known} />
        {job.state === 'armed' && may('operator') && (
          <div class="act-left"><Button big disabled={acts.off} onClick={() => acts.run('disarm', {})}>{say.disarm}</Button></div>
        )}
      </section>
      <section ref={act} class="machine-act" aria-live="polite">
        {news}
        {job.state === 'ready' && <Ready job={job} acts={acts} device={device} prepared={prepared} onPrepare={setPrepared} material={material} />}
        {job.state === 'armed' && <Armed job={job} acts={acts} device={device} />}
        {job.state === 'cutting' && <Cutting job={job} />}
        {job.state === 'paused' && <Paused job={job} acts={acts} device={device} />}
      </section>
      <Ending job={job} acts={acts} device={device} />
    </div>
  );
}

/** The cutter without a job: what was cut last, and a test cut. */
function Nothing({ device, children }: { device: Device; children?: ComponentChildren }) {
  return (
    <div class="machine machine-free">
      <header class="machine-head">
        <a class="back" href="#/">‹ {words.views.now}</a>
        <h1>{device.title}</h1>
      </header>
      <section class="machine-act">
        <Elsewhere device={device} />
        <Fault device={device} />
        {children}
        <p class="act-next">{say.nothing(device.title)}</p>
        <p class="muted">{say.nothingWhat}</p>
        <div class="row"><LinkButton href="#/design" kind="primary" big>{words.views.design}</LinkButton></div>
      </section>
      <div class="danger-line"><strong>{say.danger}</strong>
        <span class="danger-acts"><TestCut device={device} material={null} /></span></div>
    </div>
  );
}

export function Machine({ device: id }: { device: string }) {
  const [chosen, setChosen] = useState<string | null>(null);
  const last = useRef<string | null>(null);
  if (!loaded.value) return <Loading />;
  const device = devices.value.get(id);
  if (!device) return <Note><p>{say.noDevice}</p><p><a href="#/">{words.toNow}</a></p></Note>;
  const all = jobsAt(device);
  const urgent = all[0] && all[0].state !== 'ready' ? all[0] : undefined;
  const job = urgent ?? all.find((one) => one.id === chosen) ?? all[0];
  const before = last.current !== null && last.current !== job?.id ? jobs.value.get(last.current) : undefined;
  const removed = last.current !== null && removedBy.value.has(last.current) ? removedBy.value.get(last.current) ?? null : undefined;
  const news = before && hasEnded(before) ? (
    <Note kind={before.state === 'done' ? 'good' : 'amber'}>
      <p role="status">{before.state === 'done' ? say.finishedWhat(nameOf(before))
        : say.endedWhat(nameOf(before), words.states[before.state] ?? before.state)}</p>
      {before.state === 'done' && before.plan && <p><LinkButton kind="primary" href={glueOf(before.plan)}>{say.howToFold}</LinkButton></p>}
    </Note>
  ) : removed !== undefined ? <Note kind="amber"><p role="status">{say.removed(removed ?? words.changed.someone)}</p></Note> : null;
  if (!job) return <Nothing device={device}>{news}</Nothing>;
  if (!before || job.state !== 'ready') last.current = job.id;
  return (
    <>
      {news && <div class="machine-news">{news}</div>}
      <AtJob key={job.id} job={job} device={device} others={all.filter((one) => one.id !== job.id)} onChoose={setChosen} />
    </>
  );
}

