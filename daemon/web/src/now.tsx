// Now: what waits for a person, what is cut, what comes next.
import { useRef, useState } from 'preact/hooks';
import type { ComponentChildren } from 'preact';
import { hand } from './handed';
import type { Device, Job } from './model';
import { Button, Dialog, LinkButton, Loading, Meter, Picture, Trouble, useAct } from './parts';
import { atDevice, sheetsOf } from './route';
import { act, send, type ServerProblem } from './server';
import {
  deviceTitle, devices, hasEnded, isPausing, jobs, loaded, localTime, may, me, now, operatorOf, ownerOf, progressOf,
  queueOrder, recentlyDone, stale,
} from './store';
import { duration, hourMinute, percent, timeRange, words } from './words';

declare const EXAMPLE_PICTURES: Record<string, string>;
declare const EXAMPLE_GROUPS: Record<'cards' | 'paper', string[]>;

const nameOf = (job: Job): string => job.name ?? words.unnamed;
const pictureOf = (job: Job): string | null => (job.design
  ? `/v1/designs/${encodeURIComponent(job.design)}/deployed.svg` : null);

/** The share of the current sheet that is probably cut, 0 to 1. */
export function shareCut(job: Job): number {
  const live = progressOf.value.get(job.id);
  const done = live?.paths_done ?? job.progress.paths_done ?? job.progress.paths_certain;
  const all = live?.paths ?? job.progress.paths_total;
  return all > 0 ? Math.min(1, done / all) : 0;
}

/** Seconds that the cut of the current sheet still takes, least and most; of the whole job before the cut tells. */
export function remaining(job: Job): readonly number[] {
  const live = progressOf.value.get(job.id);
  const [least = 0, most = 0] = live?.remaining_s ?? job.est.remaining_s;
  if (live?.seconds_left === undefined) return [least, most];
  const middle = (least + most) / 2;
  const spread = middle > 0 ? (most - least) / 2 / middle : 0.1;
  return [live.seconds_left * (1 - spread), live.seconds_left * (1 + spread)];
}

/** What the plan of `job` is at, in words; null if it is not planned now, or nothing was told. */
export function planningAt(job: Job): string | null {
  const live = job.state === 'planning' ? progressOf.value.get(job.id) : undefined;
  const phase = live && words.planPhases[live.phase];
  if (!phase) return null;
  return typeof live.share === 'number' ? `${phase}, ${percent(live.share)}` : phase;
}

/** The sentence that says what a person must do, or null. */
export function waitSentence(job: Job): string | null {
  if (job.state === 'armed') return words.now.armed(operatorOf(job) ?? words.nobody);
  if (job.state === 'paused') return words.machine.pausedWhat;
  const kind = job.attention?.kind;
  if (!kind) return null;
  const device = deviceTitle(job.device) || job.load?.machine || '';
  const say = words.attentions;
  if (kind === 'load_sheet') {
    return say.load_sheet(job.attention!.sheet, job.attention!.total, job.load?.material ?? job.material ?? '', device);
  }
  const judged = kind === 'confirm_result' || kind === 'media_out';
  if (kind === 'in_doubt' || (job.state === 'interrupted' && !judged)) return say.in_doubt(percent(shareCut(job)));
  return say[kind](device);
}

/** Whether `job` can be cut at `device`: it is its cutter, or the job names none, is planned for this model and not for another site. */
export function fits(job: Job, device: Device): boolean {
  if (job.device !== null) return job.device === device.id;
  if (job.site && job.site !== device.site) return false;
  return job.load !== null && (device.machine === job.load.machine || device.model === job.load.machine);
}

/** The cutter at which `job` can be seen to, a free one first; null if there is none. */
export function machineOf(job: Job): string | null {
  const fitting = [...devices.value.values()].filter((device) => fits(job, device));
  return (fitting.find((device) => device.state === 'idle') ?? fitting[0])?.id ?? null;
}

/** Whether the cutter is at another popcutd of the fleet: its knife moves only for people who ask there. */
export const isElsewhere = (device: Device): boolean => !!device.node_url;

function Cutter({ device }: { device: Device }) {
  const job = device.job ? jobs.value.get(device.job) : undefined;
  const state = words.deviceStates[device.state] ?? device.state;
  const place = [isElsewhere(device) && device.node, device.site].filter(Boolean).join(', ');
  const busy = job && (job.state === 'cutting' || job.state === 'paused');
  const said = !device.enabled ? words.now.disabled
    : busy ? words.now.busyName(words.states[job.state] ?? '', nameOf(job), job.sheet ?? 1, job.sheets_total) : state;
  return (
    <a class={`cutter cutter-${device.enabled ? device.state : 'offline'}`} href={atDevice(device.id)}>
      <strong>{device.title}</strong>
      <span>{said}{device.simulated ? ` (${words.now.simulated})` : ''}</span>
      {place && <span>{words.now.atNode(place)}</span>}
      {device.reasons.length > 0 && <span class="server-words">{device.reasons.join(' ')}</span>}
    </a>
  );
}

function Row({ job, children, end }: { job: Job; children: ComponentChildren; end?: ComponentChildren }) {
  return (
    <li class="job-row">
      <Picture path={pictureOf(job)} alt="" class="picture-row" />
      <div class="job-what">
        <strong class="job-name">{nameOf(job)}</strong>
        {children}
      </div>
      {end && <div class="job-end">{end}</div>}
    </li>
  );
}

function Waiting({ job }: { job: Job }) {
  const machine = machineOf(job);
  const look = job.state === 'interrupted';
  return (
    <Row job={job} end={(
      <>
        {machine && (
          <LinkButton kind="primary" href={atDevice(machine)}>
            {look ? words.now.lookAtIt : words.now.goToMachine}
          </LinkButton>
        )}
        {isUncut(job) && <More job={job} />}
      </>
    )}>
      <span>{waitSentence(job)}</span>
      <span class="muted">{ownerOf(job)}</span>
    </Row>
  );
}

function Cutting({ job }: { job: Job }) {
  const left = remaining(job);
  const share = shareCut(job);
  const most = left[1] ?? left[0] ?? 0;
  return (
    <Row job={job} end={job.device && <LinkButton href={atDevice(job.device)}>{words.now.watch}</LinkButton>}>
      <span class="cut-line">
        <span>{words.now.sheetOf(job.sheet ?? 1, job.sheets_total)}</span>
        <Meter share={share} label={nameOf(job)} />
        <span class="figure">{percent(share)}</span>
      </span>
      <span class="muted">
        {job.state === 'paused' ? words.states.paused : isPausing(job) ? words.states.pausing
          : `${words.now.left(timeRange(left))}, ${words.now.until(hourMinute(now.value + most * 1000))}`}
        {` · ${deviceTitle(job.device)}`}
      </span>
    </Row>
  );
}

function mayChange(job: Job): boolean {
  return may('operator') || (may('submitter') && job.owner === me.value?.name);
}

/** Plans a job that nothing is cut of for another cutter, with the same options. */
function OtherCutter({ job, onClose }: { job: Job; onClose: () => void }) {
  const others = [...devices.value.values()].filter((device) => device.enabled && device.id !== job.device);
  const [chosen, setChosen] = useState(others[0]?.id ?? '');
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const { busy, run } = useAct(setProblem);
  const plan = (): void => {
    void run(() => send('PATCH', `/v1/jobs/${job.id}`, { body: { device: chosen, plan_again: true }, rev: job.rev }))
      .then((worked) => { if (worked) onClose(); });
  };
  return (
    <Dialog title={words.now.otherCutter} yes={words.now.planAgain} busy={busy || chosen === '' || stale.value} onNo={onClose} onYes={plan}>
      <p>{words.now.otherCutterWhat}</p>
      <label class="field"><span>{words.now.cutter}</span>
        <select value={chosen} onChange={(event) => setChosen(event.currentTarget.value)}>
          {others.map((device) => <option key={device.id} value={device.id} selected={device.id === chosen}>{device.title}</option>)}
        </select>
      </label>
      {problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}
    </Dialog>
  );
}

/** Whether nothing of the job is cut or about to be, so that it can be planned anew. */
const isUncut = (job: Job): boolean => ['queued', 'planning', 'ready'].includes(job.state) && (job.sheet ?? 1) === 1 && (job.blank ?? 1) <= 1;

function More({ job }: { job: Job }) {
  const [open, setOpen] = useState(false);
  const [sure, setSure] = useState(false);
  const [other, setOther] = useState(false);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const { busy, run } = useAct(setProblem);
  const off = busy || stale.value;
  const post = (path: string, body: unknown, rev?: number) => () => {
    void run(() => act(path, rev, body)).then((worked) => { if (worked) setOpen(false); });
  };
  const firstOther = queueOrder.value.find((id) => id !== job.id && jobs.value.get(id)?.priority === job.priority);
  return (
    <div class="more">
      <button type="button" class="button button-quiet more-button" aria-expanded={open}
        aria-label={words.moreActs(nameOf(job))} onClick={() => setOpen(!open)}>
        <svg viewBox="0 0 24 24" aria-hidden="true"><circle cx="5" cy="12" r="2" /><circle cx="12" cy="12" r="2" /><circle cx="19" cy="12" r="2" /></svg>
      </button>
      {open && (
        <div class="more-list">
          {job.plan && <a class="button button-quiet" href={sheetsOf(job.plan)}>{words.now.plan}</a>}
          {may('operator') && !job.held && (
            <Button kind="quiet" disabled={off} onClick={post('/v1/queue/actions/hold', { job: job.id })}>{words.now.hold}</Button>
          )}
          {may('operator') && job.held && (
            <Button kind="quiet" disabled={off} onClick={post('/v1/queue/actions/release', { job: job.id })}>{words.now.release}</Button>
          )}
          {may('operator') && firstOther && (
            <Button kind="quiet" disabled={off} onClick={post('/v1/queue/actions/move', { job: job.id, before: firstOther })}>
              {words.now.first}
            </Button>
          )}
          {mayChange(job) && isUncut(job) && devices.value.size > 1 && (
            <Button kind="quiet" disabled={off} onClick={() => { setOpen(false); setOther(true); }}>{words.now.otherCutter}</Button>
          )}
          {mayChange(job) && <Button kind="quiet" disabled={off} onClick={() => setSure(true)}>{words.now.cancel}</Button>}
          {problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}
        </div>
      )}
      {other && <OtherCutter job={job} onClose={() => setOther(false)} />}
      {sure && (
        <Dialog title={words.machine.cancelJobSure(nameOf(job))} yes={words.machine.cancelJobGo} kind="danger" busy={busy}
          onNo={() => setSure(false)}
          onYes={() => { setSure(false); post(`/v1/jobs/${job.id}/actions/cancel`, {}, job.rev)(); }}>
          <p>{words.machine.cancelJobWhat}</p>
        </Dialog>
      )}
    </div>
  );
}

function Next({ job }: { job: Job }) {
  const planned = job.sheets_total > 0 && job.plan !== null;
  return (
    <Row job={job} end={<More job={job} />}>
      <span class="next-line">
        <span>{job.held ? words.states.held : words.states[job.state]}</span>
        {planningAt(job) && <span class="muted">{planningAt(job)}</span>}
        <span class="muted">{ownerOf(job)}</span>
        {planned && <span>{words.sheets(job.sheets_total)}</span>}
        {(job.load?.material ?? job.material) && <span>{job.load?.material ?? job.material}</span>}
        {planned && <span class="figure">{timeRange(job.est.remaining_s)}</span>}
        {job.handwork && <span class="muted">{words.toFold(job.handwork.fold_s, job.handwork.label)}</span>}
      </span>
      {waitSentence(job) && <span>{waitSentence(job)}</span>}
    </Row>
  );
}

/** Unfinished jobs in three groups; a job stands in the first that fits. */
function groups(): { waiting: Job[]; cutting: Job[]; next: Job[] } {
  const open = [...jobs.value.values()].filter((job) => !hasEnded(job));
  const place = new Map(queueOrder.value.map((id, at) => [id, at]));
  const order = (a: Job, b: Job): number => (place.get(a.id) ?? 1e9) - (place.get(b.id) ?? 1e9) || a.id.localeCompare(b.id);
  const cutting = open.filter((job) => job.state === 'cutting' || job.state === 'paused');
  const waits = (job: Job): boolean => job.state === 'armed' || job.state === 'interrupted'
    || (job.attention !== null && !job.held && isFirstAtItsCutter(job, open, order));
  const waiting = open.filter((job) => !cutting.includes(job) && waits(job))
    .sort((a, b) => (a.attention?.since ?? a.created).localeCompare(b.attention?.since ?? b.created));
  const next = open.filter((job) => !cutting.includes(job) && !waiting.includes(job)).sort(order);
  return { waiting, cutting, next };
}

/** Only the first job of a cutter asks for its sheet; those behind it are "next". */
function isFirstAtItsCutter(job: Job, open: Job[], order: (a: Job, b: Job) => number): boolean {
  if (job.state !== 'ready') return true;
  const machine = machineOf(job);
  const busy = open.some((other) => other.device !== null && other.device === machine && other.id !== job.id
    && ['armed', 'cutting', 'paused'].includes(other.state));
  const before = open.some((other) => other.state === 'ready' && !other.held && other.id !== job.id
    && machineOf(other) === machine && order(other, job) < 0);
  return !busy && !before;
}

function NextHeading({ next }: { next: Job[] }) {
  const planned = next.filter((job) => job.plan !== null);
  const most_s = planned.reduce((sum, job) => sum + (job.est.remaining_s[1] ?? 0), 0);
  const sheets = planned.reduce((sum, job) => sum + Math.max(0, job.sheets_total - (job.sheet ?? 1) + 1), 0);
  return (
    <h2>{words.now.next} <span class="muted">
      {most_s > 0 ? words.now.nextSumUntil(next.length, duration(most_s), sheets, hourMinute(now.value + most_s * 1000))
        : words.now.nextSum(next.length, duration(most_s), sheets)}
    </span></h2>
  );
}

function DoneLine() {
  const some = recentlyDone.value.slice(0, 5);
  if (some.length === 0) return null;
  return (
    <section>
      <h2>{words.now.done}</h2>
      <ul class="done-strip">
        {some.map((job) => (
          <li key={job.id}>
            <Picture path={pictureOf(job)} alt="" class="picture-small" />
            <span><strong class="job-name">{nameOf(job)}</strong>
              <span class="muted">{words.states[job.state]}{job.finished ? ` ${hourMinute(localTime(job.finished))}` : ''}</span></span>
          </li>
        ))}
        <li><a href="#/done">{words.now.all}</a></li>
      </ul>
    </section>
  );
}

/** The examples as pictures, in their groups: each leads to Design. */
export function Examples() {
  return (
    <>
      {(['cards', 'paper'] as const).map((group) => (
        <section key={group}>
          <h3>{words.examples[group]}</h3>
          <ul class="examples">
            {EXAMPLE_GROUPS[group].map((name) => (
              <li key={name}>
                <a href={`#/design/example/${name}`}>
                  <img src={EXAMPLE_PICTURES[name]} alt="" loading="lazy" width={180} height={180} /><span>{name}</span>
                </a>
              </li>
            ))}
          </ul>
        </section>
      ))}
    </>
  );
}

/** Goes to Design with a file. */
function OpenFile() {
  const input = useRef<HTMLInputElement>(null);
  return (
    <p>
      <Button kind="primary" big onClick={() => input.current?.click()}>{words.now.open}</Button>
      <input ref={input} type="file" multiple class="visually-hidden" tabIndex={-1} aria-hidden="true"
        onChange={(event) => hand({ entries: [], files: [...event.currentTarget.files ?? []] })} />
    </p>
  );
}

const kShown = 60;

function JobList({ list, children }: { list: Job[]; children: (job: Job) => ComponentChildren }) {
  return (
    <>
      <ul class="job-list">{list.slice(0, kShown).map((job) => children(job))}</ul>
      {list.length > kShown && <p class="muted">{words.now.more(list.length - kShown)}</p>}
    </>
  );
}

export function Now() {
  if (!loaded.value) return <Loading />;
  const { waiting, cutting, next } = groups();
  const all = [...devices.value.values()];
  const empty = waiting.length + cutting.length + next.length === 0;
  return (
    <div class="now">
      <h1 class="visually-hidden">{words.views.now}</h1>
      <section class="cutters" aria-label={words.now.cutters}>
        {all.map((device) => <Cutter key={device.id} device={device} />)}
        {all.length === 0 && <div class="note note-plain"><p><strong>{words.now.noDevice}</strong></p><p>{words.now.noDeviceWhat}</p></div>}
      </section>
      {waiting.length > 0 && (
        <section class="waiting"><h2>{words.now.waiting}</h2>
          <JobList list={waiting}>{(job) => <Waiting key={job.id} job={job} />}</JobList></section>
      )}
      {cutting.length > 0 && (
        <section><h2>{words.now.cutting}</h2>
          <JobList list={cutting}>{(job) => <Cutting key={job.id} job={job} />}</JobList></section>
      )}
      {next.length > 0 && (
        <section><NextHeading next={next} /><JobList list={next}>{(job) => <Next key={job.id} job={job} />}</JobList></section>
      )}
      {empty && (
        <section class="empty">
          <h2>{words.now.empty}</h2>
          <p>{words.now.what}</p>
          {may('submitter') && <OpenFile />}
          <p>{words.now.emptyWhat}</p>
          <Examples />
        </section>
      )}
      <DoneLine />
    </div>
  );
}

