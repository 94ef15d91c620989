// What this page knows of popcutd: read once, then kept true by its events.
import { batch, computed, signal } from '@preact/signals';
import { EventStream, type StreamEvent } from './events';
import { includes, type Ability, type Device, type Job, type Meta, type Progress, type Role } from './model';
import { isProblem, read, session } from './server';

export const meta = signal<Meta | null>(null);
export const jobs = signal<ReadonlyMap<string, Job>>(new Map());
export const devices = signal<ReadonlyMap<string, Device>>(new Map());
export const queueOrder = signal<string[]>([]);
export const recentlyDone = signal<Job[]>([]);
export const progressOf = signal<ReadonlyMap<string, Progress>>(new Map());
export const loaded = signal(false);

/** Who changed a job, to what and when: as far as this page saw it. */
export interface Change { who: string | null; state: string; at: number }
export const lastChange = signal<ReadonlyMap<string, Change>>(new Map());
export const removedBy = signal<ReadonlyMap<string, string | null>>(new Map());

/** Grows with each event about a plan, a design or a sheet: what shows them reads them again. */
export const notices = signal<{ number: number; latest: Record<string, unknown> | null }>({ number: 0, latest: null });

export const connection = signal<{ open: boolean; at: number }>({ open: false, at: 0 });
export const now = signal(Date.now());
setInterval(() => { now.value = Date.now(); }, 500);

/** How far the clock of popcutd is ahead of this one, ms. */
let ahead_ms = 0;
function heardTime(text: unknown): void {
  const server = typeof text === 'string' ? Date.parse(text) : NaN;
  if (Number.isFinite(server)) ahead_ms = server - Date.now();
}

/** A time of popcutd as a time of this browser's clock, ms. */
export const localTime = (at: string): number => Date.parse(at) - ahead_ms;

export const me = computed(() => meta.value?.principal ?? null);
export const may = (least: Role): boolean => me.value !== null && includes(me.value.role, least);

const kMoving = ['cutting'];
export const moving = computed(() => [...jobs.value.values()].filter((job) => kMoving.includes(job.state)));
export const pausable = computed(() => [...jobs.value.values()]
  .filter((job) => job.state === 'cutting' || job.state === 'paused'));

/** No byte for so long means that what is shown may be old. */
export const quiet_ms = (): number => (moving.value.length > 0 ? 4000 : 20_000);

export const stale = computed(() => loaded.value
  && (session.value === 'over' || now.value - connection.value.at > quiet_ms()));

/** What there is to ask for here. */
export const can = (what: Ability): boolean => meta.value?.can.includes(what) ?? false;

const ended = ['done', 'failed', 'cancelled'];
export const hasEnded = (job: Job): boolean => ended.includes(job.state);

/** A pause is asked for, but the stroke has not ended. */
export const isPausing = (job: Job): boolean => job.state === 'cutting' && job.actions.includes('resume');

export const titleOf = (job: Job): string | null => job.name;
export const deviceTitle = (id: string | null): string => (id === null ? '' : devices.value.get(id)?.title ?? id);
export const ownerOf = (job: Job): string => job.owner_title ?? job.owner;
export const operatorOf = (job: Job): string | null => job.operator_title ?? job.operator;

/** Takes `job` as it is now, unless an event already told a later state. */
export function takeJob(job: Job): void {
  const known = jobs.value.get(job.id);
  if (known && known.rev > job.rev) return;
  const next = new Map(jobs.value);
  next.set(job.id, job);
  batch(() => {
    jobs.value = next;
    if (known && known.state !== job.state) changed(job);
    if (!known || known.state !== job.state) queueChanged();
    if (known && hasEnded(job) && !hasEnded(known)) doneChanged();
    if (job.state !== 'cutting' && job.state !== 'paused' && progressOf.value.has(job.id)) {
      const rest = new Map(progressOf.value);
      rest.delete(job.id);
      progressOf.value = rest;
    }
  });
}

function changed(job: Job): void {
  const all = new Map(lastChange.value);
  const known = job.state === 'armed' || job.state === 'cutting';   // the operator is who armed or started
  all.set(job.id, { who: known ? operatorOf(job) : null, state: job.state, at: Date.now() });
  lastChange.value = all;
}

function forgetJob(id: string, who: string | null): void {
  const next = new Map(jobs.value);
  next.delete(id);
  const removed = new Map(removedBy.value);
  removed.set(id, who);
  batch(() => {
    jobs.value = next;
    removedBy.value = removed;
    queueOrder.value = queueOrder.value.filter((other) => other !== id);
    recentlyDone.value = recentlyDone.value.filter((job) => job.id !== id);
  });
}

const reading = new Map<string, { again: boolean; done: Promise<void> }>();

/** Reads job `id` again; at most one request for a job is under way, and one waits behind it. */
export function readJob(id: string): Promise<void> {
  const known = reading.get(id);
  if (known) {
    known.again = true;
    return known.done;
  }
  const entry = { again: false, done: Promise.resolve() };
  reading.set(id, entry);
  entry.done = readJobOnce(id, entry);
  return entry.done;
}

async function readJobOnce(id: string, entry: { again: boolean }): Promise<void> {
  do {
    entry.again = false;
    try {
      takeJob(await read<Job>(`/v1/jobs/${id}`));
    } catch (error) {
      if (isProblem(error) && error.status === 404) forgetJob(id, null);
    }
  } while (entry.again);
  reading.delete(id);
}

/** Reads at once; what comes within `wait_ms` is read together, once, after it. */
function soon(what: () => Promise<void>, wait_ms: number): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let again = false;
  const run = (): void => {
    again = false;
    void what().catch(() => undefined);
    timer = setTimeout(() => {
      timer = undefined;
      if (again) run();
    }, wait_ms);
  };
  return () => {
    if (timer === undefined) run();
    else again = true;
  };
}

const queueChanged = soon(readQueue, 150);
const doneChanged = soon(readDone, 300);

interface Page<T> { items: T[]; next_cursor?: string | null }

async function readQueue(): Promise<void> {
  const { items } = await read<Page<Job>>('/v1/queue');
  batch(() => {
    for (const job of items) takeJob(job);
    queueOrder.value = items.map((job) => job.id);
  });
}

/** Reads the jobs that ended last, newest first. */
async function readDone(): Promise<void> {
  const { items } = await read<Page<Job>>('/v1/jobs?state=done,failed,cancelled&order=desc&limit=8');
  recentlyDone.value = items.sort((a, b) => (b.finished ?? '').localeCompare(a.finished ?? ''));
}

async function readDevices(): Promise<void> {
  const { items } = await read<Page<Device>>('/v1/devices');
  devices.value = new Map(items.map((device) => [device.id, device]));
}

function takeDevice(device: Device): void {
  const known = devices.value.get(device.id);
  if (known && known.rev > device.rev) return;
  devices.value = new Map(devices.value).set(device.id, device);
}

const devicesChanged = soon(readDevices, 150);

/** Reads who we are and which popcutd this is. Throws ServerProblem. */
export async function readMeta(): Promise<void> {
  const answer = await read<Meta>('/v1/meta');
  heardTime(answer.now);
  meta.value = answer;
}

async function readAll(): Promise<void> {
  await Promise.all([readDevices(), readQueue(), readUnfinished(), readDone().catch(() => undefined)]);
  loaded.value = true;
}

async function readUnfinished(): Promise<void> {
  const { items } = await read<Page<Job>>(
    '/v1/jobs?state=queued,planning,ready,armed,cutting,paused,interrupted&limit=200');
  takeSnapshot(items);
}

/** All unfinished jobs: those we know and that are not among them have ended or are gone. */
function takeSnapshot(items: Job[]): void {
  const present = new Set(items.map((job) => job.id));
  batch(() => {
    for (const job of items) takeJob(job);
    if (items.length >= 200) return;
    for (const job of jobs.value.values()) {
      if (!present.has(job.id) && !hasEnded(job)) void readJob(job.id);
    }
  });
}

function isWhole<T>(value: unknown): value is T {
  return typeof value === 'object' && value !== null && 'id' in value && 'rev' in value;
}

function onJob(data: Record<string, unknown>): void {
  const id = String(data.job);
  if (data.deleted) forgetJob(id, typeof data.who === 'string' ? data.who : null);
  else if (isWhole<Job>(data.whole)) takeJob(data.whole);
  else void readJob(id);
}

function onDevice(data: Record<string, unknown>): void {
  if (isWhole<Device>(data.whole)) takeDevice(data.whole);
  else devicesChanged();
}

function onProgress(data: Record<string, unknown>): void {
  const id = String(data.job);
  progressOf.value = new Map(progressOf.value).set(id, data as unknown as Progress);
  const job = jobs.value.get(id);
  if (!job || (typeof data.rev === 'number' && data.rev > job.rev)) void readJob(id);
}

function onSnapshot(data: Record<string, unknown>): void {
  if (Array.isArray(data.devices)) {
    devices.value = new Map((data.devices as Device[]).map((device) => [device.id, device]));
  }
  if (Array.isArray(data.jobs)) takeSnapshot(data.jobs as Job[]);
  queueChanged();
  doneChanged();
}

function onEvent({ kind, data }: StreamEvent): void {
  heardTime(data.now);
  if (kind === 'job') onJob(data);
  else if (kind === 'device') onDevice(data);
  else if (kind === 'progress') onProgress(data);
  else if (kind === 'queue') { queueChanged(); if (typeof data.job === 'string') void readJob(data.job); }
  else if (kind === 'snapshot') onSnapshot(data);
  else if (kind === 'notice' || kind === 'sheet') {
    notices.value = { number: notices.value.number + 1, latest: { ...data, kind } };
  }
}

let stream: EventStream | null = null;

/** Reads everything and follows the events until the session ends. */
export function follow(): void {
  stream?.stop();
  if (!can('queue')) {   // nothing happens but what this page does
    connection.value = { open: true, at: Infinity };
    loaded.value = true;
    return;
  }
  connection.value = { open: false, at: Date.now() };
  stream = new EventStream({
    event: onEvent,
    byte: () => { connection.value = { open: true, at: Date.now() }; },
    opened: () => {
      connection.value = { open: true, at: Date.now() };
      void Promise.all([readMeta(), readAll()]).catch(() => undefined);
    },
    closed: () => { connection.value = { open: false, at: connection.value.at }; },
    quiet_ms,
  });
}

/** Connects at once instead of at the next try. */
export function tryNow(): void {
  if (stream) stream.again();
  else follow();
}
