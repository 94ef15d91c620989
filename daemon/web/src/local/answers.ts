// SPDX-License-Identifier: MIT
// popcutd's part without popcutd: the requests of this page, answered by the engine in this browser (local/engine.ts)
// and by what this browser keeps (local/keep.ts). Paths, bodies and answers are those of daemon/http/api/openapi.json.
import type { Example, Machine, Meta, Plan, ProblemEntry, SheetPlan, Warning } from '../model';
import { EngineBroken, Lane, placeOf } from './engine';
import { Kind, type Bytes, type Frame, type Task } from './frames';
import { clear, exported, get, idsOf, imported, put, putFile, remove, sha256, type KeptDesign, type KeptFile } from './keep';
import { beginSearch, endSearch, findSearch, memory_GB, readyCard } from './searches';

declare const LOCAL_BUILD: string;

const utf8 = new TextEncoder();
const plain = new TextDecoder();

const quick = new Lane(true);   // what a hand that moves waits for
const slow = new Lane();

/** A request that is refused, as a problem document. */
export class Refusal extends Error {
  constructor(readonly status: number, readonly body: Record<string, unknown>) {
    super(String(body.detail));
  }
}

export const refusal = (status: number, type: string, detail: string, errors: ProblemEntry[] = []): Refusal =>
  new Refusal(status, { type: `/problems/${type}`, title: type, status, detail, errors });
const gone = (what: string): Refusal => refusal(404, 'not-found', `${what} is not kept in this browser`);

interface Tables { machines: Machine[]; rows: { machines: Record<string, unknown>; materials: Record<string, unknown> } }

/** A file of this site, read once. */
function once<T>(name: string): () => Promise<T> {
  let text: Promise<T> | null = null;
  return () => {
    text ??= fetch(placeOf(name)).then((answer) => answer.json() as Promise<T>);
    text.catch(() => { text = null; });
    return text;
  };
}
const tables = once<Tables>('tables');
const examples = once<Example[]>('examples');

/** Rows of a machine and a material for a task. Throws Refusal. */
export async function rowsOf(machine: string | null, material: string): Promise<{ machine: string; material: string }> {
  const { rows } = await tables();
  const row = (list: Record<string, unknown>, kind: 'machine' | 'material', name: string): string => {
    if (!Object.hasOwn(list, name)) {
      const detail = `there is no ${kind} "${name}"; there are ${Object.keys(list).join(', ')}`;
      throw refusal(422, 'validation', detail, [{ pointer: `/${kind}`, code: 'unknown', detail }]);
    }
    return JSON.stringify(list[name]);
  };
  return { machine: machine === null ? '' : row(rows.machines, 'machine', machine), material: row(rows.materials, 'material', material) };
}

/** The row of the material that a spec names, if there is one of the name. */
async function ownMaterial(spec: unknown): Promise<string> {
  const name = (spec as { material?: unknown } | null)?.material;
  const { rows } = await tables();
  return typeof name === 'string' && Object.hasOwn(rows.materials, name) ? JSON.stringify(rows.materials[name]) : '';
}

/** What a task may take of memory, in words for who asks for too much. */
const kBroken = 'was too much for this browser; make it smaller or simpler. Your work is kept';

interface EngineError { kind: number; place: string; detail: string }

/** ErrorKind::Internal of core/result.hpp. */
const kInternal = 0;

function refusalOf(failure: Frame): Refusal {
  const { kind, place, detail } = JSON.parse(plain.decode(failure.bytes)) as EngineError;
  const whole = place === '' ? detail : `${place}: ${detail}`;
  return kind === kInternal ? refusal(500, 'internal', whole)
    : refusal(422, 'validation', whole, [{ pointer: place, code: 'content', detail }]);
}

export interface Outcome {
  files: Map<string, Bytes>;
  figures: { design_kind: string; assets: string[]; sheets: SheetPlan[]; warnings: Warning[]; handwork: Plan['handwork']; sha256: string };
}

/** Does a task. Throws Refusal, or what the signal says. */
export async function perform(lane: Lane, task: Task, signal?: AbortSignal | null, onPhase?: (text: string) => void): Promise<Outcome> {
  let frames: Frame[];
  try {
    frames = await lane.run(task, signal, onPhase);
  } catch (error) {
    if (error instanceof EngineBroken) throw refusal(422, 'validation', `${error.message.startsWith('the engine') ? error.message : `this ${kBroken}`}`);
    throw error;
  }
  const failure = frames.find((one) => one.kind === Kind.failure);
  if (failure) throw refusalOf(failure);
  const figures = JSON.parse(plain.decode(frames.find((one) => one.kind === Kind.outcome)!.bytes)) as Outcome['figures'] & { warnings: unknown; handwork: unknown };
  const json = (text: unknown): unknown => (typeof text === 'string' && text !== '' ? JSON.parse(text) : null);
  return {
    files: new Map(frames.filter((one) => one.kind === Kind.file).map((one) => [one.name, one.bytes])),
    figures: { ...figures, warnings: (json(figures.warnings) ?? []) as Warning[], handwork: json(figures.handwork) as Plan['handwork'] },
  };
}

/** The files that a spec names and that are kept here, by id. */
async function assetsOf(design: Bytes): Promise<Map<string, Bytes>> {
  const ids = new Set(plain.decode(design).match(/sha256-[0-9a-f]{64}/g));
  const found = new Map<string, Bytes>();
  for (const id of ids) {
    const file = await get<KeptFile>('files', id);
    if (file) found.set(id, file.bytes);
  }
  return found;
}

const json = (body: unknown, status = 200): Response => new Response(JSON.stringify(body), { status, headers: { 'Content-Type': 'application/json' } });
const bytesOf = (bytes: Bytes, type: string): Response => new Response(bytes, { headers: { 'Content-Type': type } });
const done = (): Response => new Response(null, { status: 204 });
const page = (items: unknown[]): Response => json({ items, next_cursor: null });

interface Asking {
  url: URL;
  init: RequestInit;
  /** What the pattern of the path holds, decoded. */
  parts: string[];
}
const bodyOf = (of: Asking): Record<string, unknown> => JSON.parse(typeof of.init.body === 'string' ? of.init.body : '{}') as Record<string, unknown>;
const rawOf = async (of: Asking): Promise<Bytes> => new Uint8Array(await new Response(of.init.body).arrayBuffer());

/** Options of a plan, as the engine takes them. */
const textOptions = (options: unknown): Record<string, string> => Object.fromEntries(
  Object.entries((options ?? {}) as Record<string, unknown>).map(([name, value]) => [name, String(value)]));

interface Stored { about: KeptDesign; bytes: Bytes }

async function stored(id: string): Promise<Stored> {
  const about = await get<KeptDesign>('designs', id);
  const file = about && await get<KeptFile>('files', id);
  if (!about || !file) throw gone('this design');
  return { about, bytes: file.bytes };
}

/** A task on a stored design. */
async function taskOf(kind: Task['kind'], { about, bytes }: Stored, more: Partial<Task> = {}): Promise<Task> {
  const material = about.kind === 'spec' ? await ownMaterial(JSON.parse(plain.decode(bytes))) : '';
  return { kind, design: bytes, designKind: about.kind, assets: await assetsOf(bytes), material, ...more };
}

const kLattice = 'application/vnd.popcut.lattice';
const kUsualMachine = 'cameo3';
const kUsualMaterial = 'paper-220';

/** Of a file, for each GB of this computer: a model of so many bytes takes up to twenty times as much to design. */
const kMost_bytes = 16 << 20;
/** Of an STL file, whose triangles take the most; those of a GLB share their corners. */
const kTriangle_bytes = 50;

function meta(): Meta {
  const most = Math.round(memory_GB * kMost_bytes);
  return {
    api: 'v1', build: LOCAL_BUILD, page: '', page_url: null, schema_sha256: '', now: new Date().toISOString(),
    can: ['design', 'plan', 'search', 'print', 'keep'], principal: { name: 'you', title: '', role: 'submitter' },
    session: false, tablet: null, last_event: 0, workers: { confined_by: [], not_confined_by: [] },
    limits: { json_bytes: 1 << 20, json_depth: 64, design_bytes: most, asset_bytes: most, rate_per_s: 0, rate_burst: 0, connections: 0, streams: 0,
      ...{ triangles: Math.round(most / kTriangle_bytes) } },
  };
}

async function postDesign(of: Asking): Promise<Response> {
  const bytes = await rawOf(of);
  const name = of.url.searchParams.get('name') ?? '';
  const { figures } = await perform(slow, { kind: 'check', design: bytes, assets: await assetsOf(bytes) }, of.init.signal);
  const id = await putFile(bytes, name, 'design');
  const about: KeptDesign = { id, name, kind: figures.design_kind, bytes: bytes.length, created: new Date().toISOString(), assets: figures.assets };
  await put('designs', id, about);
  return json({ ...about, warnings: figures.warnings }, 201);
}

async function postAsset(of: Asking): Promise<Response> {
  const bytes = await rawOf(of);
  const name = of.url.searchParams.get('name') ?? '';
  const type = new Headers(of.init.headers).get('Content-Type') ?? '';
  return json({ id: await putFile(bytes, name, type), name, bytes: bytes.length, links: {} }, 201);
}

async function ofSpec(of: Asking, kind: 'preview' | 'place'): Promise<Outcome> {
  const { spec, quality, place, up, front } = bodyOf(of) as { spec: unknown } & Record<string, string | undefined>;
  const design = utf8.encode(JSON.stringify(spec));
  const options = Object.fromEntries(Object.entries({ quality, place, up: up ?? (place && 'any'), front: front ?? (place && 'any') })
    .filter((one): one is [string, string] => one[1] !== undefined));
  const task: Task = { kind, design, designKind: 'spec', options, material: await ownMaterial(spec), assets: await assetsOf(design) };
  return perform(quick, task, of.init.signal);
}

const only = ({ files }: Outcome): Bytes => [...files.values()][0]!;

/** The newest first. */
async function designs(): Promise<KeptDesign[]> {
  const all = await Promise.all((await idsOf('designs')).map((id) => get<KeptDesign>('designs', id)));
  return all.filter((one): one is KeptDesign => one !== undefined).sort((a, b) => b.created.localeCompare(a.created));
}

interface KeptPlan { body: Plan; files: Map<string, Bytes>; machine: string; material: string; options: Record<string, string> }

async function postPlan(of: Asking): Promise<Response> {
  const [id = ''] = of.parts;
  const design = await stored(id);
  const body = bodyOf(of);
  const spec = design.about.kind === 'spec' ? JSON.parse(plain.decode(design.bytes)) as { material?: unknown } : {};
  const machine = String(body.machine ?? kUsualMachine);
  const material = String(body.material ?? spec.material ?? kUsualMaterial);
  const rows = await rowsOf(machine, material);
  const options = textOptions(body.options);
  const { files, figures } = await perform(slow, await taskOf('plan', design, { ...rows, options }), of.init.signal);
  const sum = (figure: (of: SheetPlan) => number): number => figures.sheets.reduce((all, one) => all + figure(one), 0);
  // The same design, planned in the same way by the same engine, is the same plan.
  const plan = (await sha256(utf8.encode(JSON.stringify([id, rows, options, LOCAL_BUILD])))).slice(0, 32);
  const made: Plan = {
    id: plan, design: id, material, machine, state: 'planned', sha256: figures.sha256, sheets: figures.sheets, sheets_total: figures.sheets.length,
    paths: sum((one) => one.paths), length_mm: sum((one) => one.cut_mm + one.fold_mm),
    est_s: [sum((one) => one.seconds_range[0]), sum((one) => one.seconds_range[1])],
    handwork: figures.handwork, warnings: figures.warnings, error: null, created: new Date().toISOString(),
    links: { self: `/v1/plans/${plan}`, design: `/v1/designs/${id}` },
  };
  await put('plans', plan, { body: made, files, ...rows, options } satisfies KeptPlan);
  return json(made, 202);
}

async function planned(id: string): Promise<KeptPlan> {
  const plan = await get<KeptPlan>('plans', id);
  if (!plan) throw gone('this plan');
  return plan;
}

const sheetFile = (sheet: string, ending: string): string => `sheet-${sheet.padStart(2, '0')}.${ending}`;

async function planFile(id: string, name: string, type: string): Promise<Response> {
  const bytes = (await planned(id)).files.get(name);
  if (!bytes) throw gone('this sheet');
  return bytesOf(bytes, type);
}

async function artwork(of: Asking): Promise<Response> {
  const [id = '', sheet = ''] = of.parts;
  const plan = await planned(id);
  const asked = of.url.searchParams;
  const options = {
    ...plan.options, 'artwork-sheet': sheet, 'artwork-mode': asked.get('mode') ?? 'view', 'artwork-dpi': asked.get('dpi') ?? '300',
    'artwork-clay': asked.get('clay') ?? 'false', 'artwork-back': asked.get('back') ?? 'false', 'artwork-model': '',
    'artwork-sha256': plan.body.sheets[Number(sheet) - 1]?.program_sha256 ?? '',
  };
  const task = await taskOf('artwork', await stored(plan.body.design), { machine: plan.machine, material: plan.material, options });
  return bytesOf(only(await perform(slow, task, of.init.signal)), 'application/pdf');
}

async function make(of: Asking): Promise<Response> {
  const design = await stored(of.parts[0] ?? '');
  const body = bodyOf(of);
  const way = String(body.way);
  // As daemon/planning/make/make_ways.hpp has them.
  const usual: Record<string, string | undefined> = { hand: 'none', cricut: 'cricut-maker', silhouette: 'cameo3' };
  const spec = design.about.kind === 'spec' ? JSON.parse(plain.decode(design.bytes)) as { material?: unknown } : {};
  const machine = typeof body.machine === 'string' ? body.machine : usual[way] ?? null;
  const rows = await rowsOf(machine, String(body.material ?? spec.material ?? kUsualMaterial));
  const task = await taskOf('make', design, { ...rows, options: { ...textOptions(body.options), 'make-way': way } });
  const text = plain.decode(only(await perform(slow, task, of.init.signal)));
  if (!text.startsWith('{"asks":')) return new Response(text, { headers: { 'Content-Type': 'application/json' } });
  const { asks, detail } = JSON.parse(text) as { asks: { asks?: string }; detail: string };
  const refused = refusal(422, 'validation', detail, [{ pointer: `/options/${asks.asks ?? 'layers'}`, code: 'unclear', detail: 'must say what the lines of `asks` are for' }]);
  return json({ ...refused.body, asks }, 422);
}

async function designFile(of: Asking, kind: 'lattice' | 'picture' | 'export', file: string, options: Record<string, string> = {}): Promise<Bytes> {
  const { files } = await perform(slow, await taskOf(kind, await stored(of.parts[0] ?? ''), { options }), of.init.signal);
  const bytes = files.get(file);
  if (!bytes) throw gone(file);
  return bytes;
}

const typeOf = (file: string): string => (file.endsWith('.svg') ? 'image/svg+xml' : file.endsWith('.json') || file.endsWith('.fold') ? 'application/json'
  : file.endsWith('.glb') ? 'model/gltf-binary' : 'application/octet-stream');

type Route = [method: string, pattern: RegExp, act: (of: Asking) => Promise<Response> | Response];

const routes: Route[] = [
  ['GET', /^\/v1\/meta$/, () => json(meta())],
  ['GET', /^\/v1\/examples$/, async () => page(await examples())],
  ['GET', /^\/v1\/machines$/, async () => page((await tables()).machines)],
  ['GET', /^\/v1\/materials$/, async () => page(Object.entries((await tables()).rows.materials)
    .map(([id, material]) => ({ id, rev: 1, built_in: true, material })))],
  ['GET', /^\/v1\/devices$/, () => page([])],
  ['POST', /^\/v1\/preview$/, async (of) => bytesOf(only(await ofSpec(of, 'preview')), kLattice)],
  ['POST', /^\/v1\/place$/, async (of) => json({ spec: JSON.parse(plain.decode(only(await ofSpec(of, 'place')))) as unknown })],
  ['POST', /^\/v1\/assets$/, postAsset],
  ['POST', /^\/v1\/assets\/([^/]+)\/search$/, async (of) => json(await beginSearch(of.parts[0] ?? '', bodyOf(of)), 202)],
  ['GET', /^\/v1\/searches\/([^/]+)$/, async (of) => json(await findSearch(of.parts[0] ?? ''))],
  ['DELETE', /^\/v1\/searches\/([^/]+)$/, async (of) => {
    await endSearch(of.parts[0] ?? '');
    return done();
  }],
  ['GET', /^\/v1\/searches\/([^/]+)\/cards\/(\d+)\.png$/, async (of) => bytesOf(await readyCard(of.parts[0] ?? '', of.parts[1] ?? '', 'png'), 'image/png')],
  ['GET', /^\/v1\/searches\/([^/]+)\/cards\/(\d+)\/lattice$/, async (of) => bytesOf(await readyCard(of.parts[0] ?? '', of.parts[1] ?? '', 'lattice'), kLattice)],
  ['POST', /^\/v1\/designs$/, postDesign],
  ['GET', /^\/v1\/designs$/, async () => page(await designs())],
  ['DELETE', /^\/v1\/designs\/([^/]+)$/, async (of) => {
    await remove('designs', of.parts[0] ?? '');
    return done();
  }],
  ['GET', /^\/v1\/kept$/, async () => new Response(await exported())],
  ['POST', /^\/v1\/kept$/, async (of) => {
    const count = await imported(new Blob([await rawOf(of)]));
    if (count === null) throw refusal(422, 'validation', 'this is no file that popcut keeps its designs in; choose one that "Save everything" made');
    return json({ designs: count });
  }],
  ['DELETE', /^\/v1\/kept$/, async () => {
    await clear();
    return done();
  }],
  ['GET', /^\/v1\/designs\/([^/]+)$/, async (of) => json((await stored(of.parts[0] ?? '')).about)],
  ['GET', /^\/v1\/designs\/([^/]+)\/content$/, async (of) => bytesOf((await stored(of.parts[0] ?? '')).bytes, 'application/json')],
  ['GET', /^\/v1\/designs\/([^/]+)\/lattice$/, async (of) => bytesOf(await designFile(of, 'lattice', 'lattice', textOptions(Object.fromEntries(of.url.searchParams))), kLattice)],
  ['GET', /^\/v1\/designs\/([^/]+)\/deployed\.svg$/, async (of) => bytesOf(await designFile(of, 'picture', 'deployed.svg'), 'image/svg+xml')],
  ['GET', /^\/v1\/designs\/([^/]+)\/files\/([^/]+)$/, async (of) => {
    const file = of.parts[1] ?? '';
    return bytesOf(await designFile(of, 'export', file, { file, part: of.url.searchParams.get('part') ?? '1' }), typeOf(file));
  }],
  ['POST', /^\/v1\/designs\/([^/]+)\/make$/, make],
  ['POST', /^\/v1\/designs\/([^/]+)\/plan$/, postPlan],
  ['GET', /^\/v1\/plans\/([^/]+)$/, async (of) => json((await planned(of.parts[0] ?? '')).body)],
  ['GET', /^\/v1\/plans\/([^/]+)\/plan\.json$/, (of) => planFile(of.parts[0] ?? '', 'plan.json', 'application/json')],
  ['GET', /^\/v1\/plans\/([^/]+)\/sheets\/(\d+)\.svg$/, (of) => planFile(of.parts[0] ?? '', sheetFile(of.parts[1] ?? '', 'svg'), 'image/svg+xml')],
  ['GET', /^\/v1\/plans\/([^/]+)\/sheets\/(\d+)\/strokes$/, (of) => planFile(of.parts[0] ?? '', sheetFile(of.parts[1] ?? '', 'strokes.json'), 'application/json')],
  ['GET', /^\/v1\/plans\/([^/]+)\/sheets\/(\d+)\/artwork\.pdf$/, artwork],
];

/** As popcutd answers; what it alone can do is not found. Throws what the signal of the request says. */
export async function answer(path: string, init: RequestInit): Promise<Response> {
  const url = new URL(path, location.origin);
  const method = init.method ?? 'GET';
  for (const [wanted, pattern, act] of routes) {
    const found = wanted === method ? pattern.exec(url.pathname) : null;
    if (!found) continue;
    try {
      return await act({ url, init, parts: found.slice(1).map(decodeURIComponent) });
    } catch (error) {
      if (error instanceof Refusal) return json(error.body, error.status);
      if (init.signal?.aborted) throw error;
      return json(refusal(422, 'validation', 'a part of this page cannot be loaded; check the connection and try again').body, 422);
    }
  }
  return json(refusal(404, 'not-found', 'this needs popcutd').body, 404);
}

// Loads what the first design needs, while somebody looks at the page. Then tries it out, where the browser compiles well
// only what has run for a while (Chromium), and where memory and a battery allow it.
quick.warm();
const kRehearsed = utf8.encode(JSON.stringify({ popcut: 1, surface: { type: 'revolution', radius: '50' }, units_per_slice: 10, slices: 50, widths_mm: 2 }));
const { userAgentData } = navigator as Navigator & { userAgentData?: { mobile: boolean } };   // of Chromium only
if (userAgentData?.mobile === false && memory_GB >= 4) {
  quick.rehearse(['draft', 'exact', 'draft', 'exact'].map((quality) => ({ kind: 'preview', design: kRehearsed, designKind: 'spec', options: { quality } })));
}
