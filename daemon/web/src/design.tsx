// SPDX-License-Identifier: MIT
// Design: from a shape to an exact card, by hand.
import { useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import { useAgain } from './again';
import * as desk from './design_desk';
import { Panel, sheetBox } from './design_panel';
import { shownModel, Stage } from './design_stage';
import { Start } from './design_start';
import { DrawingQuestion, mustAnswer, optionsOf } from './drawing';
import { handed } from './handed';
import { MakeDialog } from './make';
import { filesOf, type Given } from './model_files';
import * as opening from './model_open';
import { openInSimulator } from './origami_simulator';
import * as outfit from './outfit';
import { OutfitChoice } from './outfit_choice';
import { Button, Choice, Dialog, Trouble, useAsking } from './parts';
import { prints } from './preferences';
import { go, parseRoute, route, sheetsOf } from './route';
import { read, readBlob, saveAs, send, ServerProblem } from './server';
import { fromShare, isPlain, nameOf, scaled, shareText, SpecError, withField } from './spec';
import { SearchCards } from './search_cards';
import * as searching from './search_desk';
import { Questions } from './standing';
import { can, may, stale } from './store';
import { tabStore } from './tab_store';
import { size } from './words';
import { designWords as words } from './words_design';
import { makeWords } from './words_make';

const rad = (degrees: number): number => (degrees * Math.PI) / 180;
const deg = (radians: number): number => (radians * 180) / Math.PI;

/** The slider that opens and shuts, with its marks. */
function Deploy() {
  const of = desk.lattice.value;
  const input = useRef<HTMLInputElement>(null);
  const playing = useSignal(false);
  const frame = useRef(0);
  const now = deg(desk.psi.value);
  const designed = of ? deg(of.design_psi_rad) : 90;
  const most = of && of.parts.length > 0 ? Math.round(designed) : 180;   // a card of parts is glued, and opens no further
  useLayoutEffect(() => {
    input.current?.style.setProperty('--at', `${(now / most) * 100}%`);
    input.current?.parentElement?.style.setProperty('--designed', String(designed / most));
  });
  const stop = (): void => {
    cancelAnimationFrame(frame.current);
    playing.value = false;
  };
  useEffect(() => stop, []);
  const play = (): void => {
    if (playing.value) {
      stop();
      return;
    }
    playing.value = true;
    const start = performance.now();
    const from = deg(desk.psi.value);
    const [middle, swing] = [most / 2 + 2, most / 2 - 6];
    const phase = Math.acos(Math.max(-1, Math.min(1, (from - middle) / swing)));
    const tick = (time: number): void => {
      desk.psi.value = rad(middle + swing * Math.cos(phase + (time - start) / 1600));
      frame.current = requestAnimationFrame(tick);
    };
    frame.current = requestAnimationFrame(tick);
  };
  if (of?.motion === 'flat') return null;
  const jump = (degrees: number): void => {
    stop();
    desk.psi.value = rad(degrees);
  };
  return (
    <div class="deploy">
      <div class="deploy-track">
        <input ref={input} type="range" min="0" max={most} step="1" value={Math.round(now)} aria-label={words.psi.label} aria-valuetext={words.psi.text(now)}
          onInput={(event) => jump(Number(event.currentTarget.value))} />
        <div class="deploy-marks">
          <button type="button" class="mark mark-shut" onClick={() => jump(0)}>{words.psi.shut}</button>
          {most > designed && <button type="button" class="mark mark-designed" onClick={() => jump(designed)}>{words.psi.designed}</button>}
          <button type="button" class="mark mark-flat" onClick={() => jump(most)}>{most < 180 ? words.psi.designed : words.psi.flat}</button>
        </div>
      </div>
      <output class="deploy-value figure">{Math.round(now)}°</output>
      <button type="button" class="button button-plain deploy-play" aria-pressed={playing.value} onClick={play}>
        {playing.value ? words.psi.stop : words.psi.play}
      </button>
    </div>
  );
}

function ShareDialog({ onClose }: { onClose: () => void }) {
  const text = useSignal<string>('');
  const link = useSignal<string | null>(null);
  useEffect(() => {
    const spec = desk.spec.peek();
    if (!spec) return;
    shareText(spec).then(async (data) => {
      link.value = new URL(`#/design/d=${data}`, document.baseURI).href;
      desk.saved();
      try {
        await navigator.clipboard.writeText(link.value);
        text.value = words.share.copied;
      } catch {
        text.value = words.share.here;
      }
    }, (error: unknown) => {
      text.value = error instanceof SpecError && error.message === 'has-files' ? words.share.hasFiles : words.share.tooLarge;
    });
  }, []);
  return (
    <Dialog title={words.share.title} onNo={onClose} no={words.close}>
      <p role="status">{text.value}</p>
      {link.value && /^(localhost|127\.|\[::1\])/.test(location.hostname) && <p class="muted">{words.share.hereOnly}</p>}
      {link.value && <label class="field"><span class="visually-hidden">{words.share.title}</span>
        <input type="text" readOnly value={link.value} class="share-link" onFocus={(event) => event.currentTarget.select()} /></label>}
    </Dialog>
  );
}

/** Films the card as it opens from `flat`, or from where it is shut, to `designed`, radians; null if it was stopped. */
async function film(view: NonNullable<typeof shownModel.view>, flat: number, designed: number, stop: AbortSignal): Promise<Blob | null> {
  const stream = view.canvas.captureStream(30);
  const type = MediaRecorder.isTypeSupported('video/webm;codecs=vp9') ? 'video/webm;codecs=vp9' : 'video/webm';
  const recorder = new MediaRecorder(stream, { mimeType: type, videoBitsPerSecond: 6_000_000 });
  const parts: Blob[] = [];
  recorder.ondataavailable = (event) => parts.push(event.data);
  const ended = new Promise<void>((done) => { recorder.onstop = () => done(); });
  view.setFilmed(true);
  recorder.start();
  const before = desk.psi.peek();
  const whole_ms = 4000;
  await new Promise<void>((done) => {
    const start = performance.now();
    const tick = (time: number): void => {
      if (stop.aborted) return done();
      const share = Math.min(1, (time - start) / whole_ms);
      const eased = share * share * (3 - 2 * share);
      desk.psi.value = flat + eased * (designed - flat);
      if (share < 1) requestAnimationFrame(tick);
      else setTimeout(done, 300);
    };
    requestAnimationFrame(tick);
  });
  recorder.stop();
  await ended;
  for (const track of stream.getTracks()) track.stop();
  view.setFilmed(false);
  desk.psi.value = before;
  return stop.aborted ? null : new Blob(parts, { type: 'video/webm' });
}

const designName = (): string => (desk.foreign.value?.name ?? nameOf(desk.spec.value ?? {})) || 'design';

const kShut_rad = 0.1;
const kOneSheetFiles = ['segments.csv', 'deploy.glb', 'deployed.stl', 'poster.svg', 'deployed.svg'];

/** All other formats, as files of the design. */
function OtherFormats() {
  const { problem, run: ask } = useAsking();
  const busy = useSignal<string | null>(null);
  const name = designName();
  const ofParts = (desk.lattice.value?.parts.length ?? 0) > 0;
  const closed = useRef(new AbortController());
  useEffect(() => () => closed.current.abort(), []);
  const makeFilm = async (of: NonNullable<typeof shownModel.view>): Promise<void> => {
    const blob = await film(of, ofParts ? kShut_rad : Math.PI, desk.lattice.peek()?.design_psi_rad ?? Math.PI / 2, closed.current.signal);
    if (blob) saveAs(blob, `${name}.webm`);
  };
  const run = (what: string, act: () => Promise<void>): Promise<void> => {
    busy.value = what;
    return ask(act).finally(() => { busy.value = null; });
  };
  const get = (file: string): Promise<void> => run(file, async () => {
    const id = await desk.storedId();
    saveAs(await readBlob(`/v1/designs/${id}/files/${file}`), `${name}-${file}`);
  });
  const blocked = useSignal(false);
  const simulate = (): void => {
    blocked.value = false;
    void run('simulator', async () => {
      const opened = await openInSimulator(async () => {
        const id = await desk.storedId();
        return JSON.parse(await (await readBlob(`/v1/designs/${id}/files/pattern.fold`)).text()) as unknown;
      });
      blocked.value = !opened;
    });
  };
  const view = shownModel.view;
  const off = busy.value !== null || !desk.canCut.value || stale.value;
  return (
    <>
      {problem.value && <Trouble problem={problem.value} />}
      {blocked.value && <p class="note note-bad" role="alert">{words.exports.blocked}</p>}
      {!desk.foreign.value && <p class="muted">{words.exports.what}</p>}
      <ul class="export-list">
        {!desk.foreign.value && Object.entries(words.exports.files).filter(([file]) => !ofParts || !kOneSheetFiles.includes(file)).map(([file, text]) => (
          <li key={file}><button type="button" class="export" disabled={off} onClick={() => void get(file)}>{text}</button></li>
        ))}
        {!desk.foreign.value && !ofParts && <li><button type="button" class="export" disabled={off} onClick={simulate}>
          {busy.value === 'simulator' ? words.exports.simulatorOpens : words.exports.simulator}</button></li>}
        {view && (
          <>
            <li><button type="button" class="export" disabled={busy.value !== null}
              onClick={() => void run('png', async () => { const blob = await view.png(); if (blob) saveAs(blob, `${name}.png`); })}>{words.exports.png}</button></li>
            <li><button type="button" class="export" disabled={busy.value !== null}
              onClick={() => void run('webm', () => makeFilm(view))}>
              {busy.value === 'webm' ? words.exports.recording : words.exports.webm}</button></li>
          </>
        )}
      </ul>
    </>
  );
}

/** Whether the card fits the paper that is chosen. */
function SizeOnPaper() {
  const of = desk.lattice.value;
  const spec = desk.spec.value;
  const paper = outfit.chosenPaper.value;
  if (!of || !paper) return null;
  const [, , width, length] = of.parts[0]?.box_mm ?? sheetBox(of);
  const factor = of.parts.length > 0 ? desk.factorToFill(of, 0) : outfit.fillFactor(width, length, 0);
  if (factor >= 1) return <p class="muted small">{words.cut.fits(size(width, length))}</p>;
  const smaller = (): void => { if (spec) desk.setFitting(scaled(spec, of.parts.length > 0 ? desk.factorToFill(of) : outfit.fillFactor(width, length))); };
  return (
    <div class="note note-amber small" role="status">
      <p>{words.cut.tooLarge(size(width, length), paper.title, outfit.marked.value)}</p>
      {spec && isPlain(spec) && <Button onClick={smaller} disabled={!desk.canCut.value}>{words.cut.smaller}</Button>}
    </div>
  );
}

function CutDialog({ onClose, print = false }: { onClose: () => void; print?: boolean }) {
  const own = String(desk.spec.value?.material ?? '');
  const material = useSignal('');
  const copies = useSignal(1);
  const { busy, problem, run } = useAsking();
  const open = useRef(true);
  useEffect(() => () => { open.current = false; }, []);
  useEffect(() => { if (print) prints.value = 'yes'; }, [print]);
  useEffect(() => { void outfit.readMaterials(); }, []);
  const plan = (): Promise<void> => run(async () => {
    const id = await desk.storedId();
    if (!open.current) return;
    const canPrint = desk.spec.peek() !== null && prints.peek() === 'yes';
    const wishes = outfit.planWishes(canPrint);
    const body: Record<string, unknown> = {
      ...(material.value ? { material: material.value } : {}), ...wishes,
      options: { ...(desk.foreign.peek() ? optionsOf(id) : {}), ...(wishes.options as Record<string, unknown>) },
    };
    const made = await send<{ id: string }>('POST', `/v1/designs/${id}/plan`, { body });
    tabStore.setItem(`popcut.cut.${made.id}`, JSON.stringify({ copies: copies.value, device: body.device ?? null }));
    if (!open.current) return;
    onClose();
    go(sheetsOf(made.id));
  });
  return (
    <Dialog title={can('queue') ? words.cut.title : words.cut.titleOfSheets} onNo={onClose} yes={words.cut.sheets} onYes={() => void plan()} busy={busy.value || !desk.canCut.value || stale.value || mustAnswer(desk.foreign.value?.id)}>
      {problem.value && <Trouble problem={problem.value} />}
      {desk.foreign.value && <DrawingQuestion design={desk.foreign.value.id} onAnswer={desk.readAgain} />}
      {!desk.canCut.value && <p class="muted" role="status">{words.cut.wait}</p>}
      {busy.value && <p class="muted" role="status">{words.cut.planning}</p>}
      {searching.isFirst.value && <p class="note note-amber" role="status">{words.cut.draft}</p>}
      <Choice label={words.cut.material} value={material.value} options={outfit.materialChoice(own)} onChange={(value) => { material.value = value; }} />
      <OutfitChoice canPrint={desk.spec.value !== null} />
      <SizeOnPaper />
      {can('queue') && <label class="field"><span>{words.cut.copies}</span>
        <input type="number" min="1" max="1000" value={copies.value} onChange={(event) => { copies.value = Math.max(1, Math.min(1000, Math.round(Number(event.currentTarget.value)) || 1)); }} />
      </label>}
    </Dialog>
  );
}

function Bar({ onOpen }: { onOpen: () => void }) {
  const dialog = useSignal<'share' | 'make' | 'cut' | 'print' | null>(null);
  const spec = desk.spec.value;
  const close = (): void => { dialog.value = null; };
  const save = (): void => {
    if (!spec) return;
    const file = `${nameOf(spec) || 'design'}.json`;
    saveAs(new Blob([JSON.stringify(spec, null, 2) + '\n'], { type: 'application/json' }), file);
    desk.note.value = words.bar.savedAs(file);
    desk.saved();
  };
  return (
    <div class="design-bar">
      {spec
        ? <input class="design-name" type="text" aria-label={words.bar.name} value={nameOf(spec)} placeholder={words.bar.unnamed} maxLength={120}
          onChange={(event) => desk.set(withField(spec, 'name', event.currentTarget.value.trim()))} />
        : <h1 class="design-name">{desk.foreign.value?.name}</h1>}
      <span class="design-dirty" title={words.bar.changed}>{desk.unsaved.value ? '●' : ''}</span>
      {spec && <>
        <Button kind="quiet" onClick={desk.stepBack} disabled={!desk.steps.value.undo}>{words.bar.undo}</Button>
        <Button kind="quiet" onClick={desk.stepForward} disabled={!desk.steps.value.redo}>{words.bar.redo}</Button>
      </>}
      <span class="design-space" />
      <Button kind="quiet" onClick={() => { desk.leave(); go('#/design'); }}>{words.bar.examples}</Button>
      <Button kind="quiet" onClick={onOpen}>{words.bar.open}</Button>
      {spec && <Button kind="quiet" onClick={() => { dialog.value = 'share'; }} disabled={!desk.canCut.value}>{words.bar.share}</Button>}
      {spec && <Button kind="quiet" onClick={save} disabled={!desk.canCut.value}>{words.bar.save}</Button>}
      <Button onClick={() => { dialog.value = 'make'; }}>{makeWords.button}</Button>
      {may('submitter') && <Button kind="primary" onClick={() => { dialog.value = 'cut'; }} disabled={stale.value}>{can('queue') ? words.bar.cut : words.bar.sheets}</Button>}
      {dialog.value === 'share' && <ShareDialog onClose={close} />}
      {dialog.value === 'make' && <MakeDialog name={designName()} onClose={close} onCut={(printed) => { dialog.value = printed ? 'print' : 'cut'; }}>
        <OtherFormats />
      </MakeDialog>}
      {(dialog.value === 'cut' || dialog.value === 'print') && <CutDialog onClose={close} print={dialog.value === 'print'} />}
    </div>
  );
}

/** How a person calls the field of a spec at `pointer`, before what is wrong with it. */
function fieldAt(pointer: string): string {
  const place = pointer.replace(/^\/spec(?=\/|$)/, '');
  const head = place.split('/')[1] ?? '';
  const { fields } = words;
  const names: Record<string, string> = {
    units_per_slice: fields.units, slices: fields.slices, widths_mm: fields.width, min_panel_mm: fields.minPanel, lattice: fields.lattice,
    splay: fields.splay, design_angle_deg: fields.angle, material: fields.material, surface: fields.shape,
  };
  return place === '' ? '' : `${names[head] ?? place}: `;
}

function Impossible() {
  const problem = desk.problem.value;
  if (!problem) return desk.isLong.value && desk.busy.value ? <p class="note" role="status">{words.problem.long}</p> : null;
  if (problem.status !== 422) return <Trouble problem={problem} onClose={() => { desk.problem.value = null; }} />;
  const first = problem.errors[0];
  const text = first ? `${fieldAt(first.pointer)}${first.detail}` : problem.detail;
  const late = desk.isLate.value;
  return (
    <div class="note note-amber impossible" role="alert">
      <p><strong>{late ? words.problem.late : words.problem.title}</strong> <span class="server-words">{late ? words.problem.lateWhat : text}</span></p>
      <p class="small">{desk.lattice.value ? late ? words.problem.shownLate : words.problem.shownOld : ''}</p>
      {late && <Button kind="primary" onClick={desk.tryAgain}>{words.problem.again}</Button>}
      {desk.steps.value.undo && <Button kind="quiet" onClick={desk.stepBack}>{words.problem.back}</Button>}
    </div>
  );
}

function Desk({ onOpen }: { onOpen: () => void }) {
  useLayoutEffect(() => { scrollTo(0, 0); }, []);   // from wherever the card was begun
  useEffect(() => {
    const onKey = (event: KeyboardEvent): void => {
      if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
      const typing = event.target instanceof HTMLInputElement && event.target.type === 'text';
      if (typing || document.querySelector('dialog[open]')) return;
      const key = event.key.toLowerCase();
      if (key === 'z' && !event.shiftKey) desk.stepBack();
      else if ((key === 'z' && event.shiftKey) || key === 'y') desk.stepForward();
      else return;
      event.preventDefault();
    };
    addEventListener('keydown', onKey);
    return () => removeEventListener('keydown', onKey);
  }, []);
  return (
    <div class="design">
      <Bar onOpen={onOpen} />
      <SearchCards />
      {desk.foreign.value && <DrawingQuestion design={desk.foreign.value.id} onAnswer={desk.readAgain} />}
      <div class="design-main">
        <div class="design-left">
          <div class="stage-wrap">
            <Stage />
            <div class="stage-notes">
              <Impossible />
              {desk.note.value && <div class="note design-note" role="status"><p>{desk.note.value}</p>
                <Button kind="quiet" onClick={() => { desk.note.value = null; }}>{words.close}</Button></div>}
            </div>
          </div>
          <Deploy />
        </div>
        <Panel />
      </div>
    </div>
  );
}

/** `#/design`, `#/design/d=…` a shared design, `#/design/example/NAME`, `#/design/ID` a stored one. */
export default function Design({ rest }: { rest: string }) {
  const file = useRef<HTMLInputElement>(null);
  const trouble = useSignal<opening.Said>(null);
  useEffect(() => { void outfit.readMachines(); }, []);

  useEffect(() => {
    if (rest === '') return undefined;
    const wanted = desk.opening();
    trouble.value = null;
    const open = async (): Promise<void> => {
      try {
        const [, key, value] = /^(d|example)[=/](.*)$/s.exec(rest) ?? ['', 'id', rest];
        if (key === 'd') {
          const spec = await fromShare(value ?? '');
          if (wanted()) desk.begin(spec);
        } else if (key === 'example') {
          const { items } = await read<{ items: desk.Example[] }>('/v1/examples');
          const found = items.find((one) => one.name === value);
          if (wanted() && found) desk.begin(found.spec);
        } else await desk.openStored(value ?? '', wanted);
        // The address is done with: what is on the desk now is one's own.
        if (location.hash !== here) return;
        history.replaceState(null, '', '#/design');
        route.value = parseRoute('#/design');
      } catch (error) {
        if (wanted()) trouble.value = opening.said(error);
      }
    };
    const here = location.hash;
    void open();
    return undefined;
  }, [rest, useAgain(trouble.value instanceof ServerProblem ? trouble.value : null)]);

  const onSaid = (said: opening.Said): void => { trouble.value = said; };
  const take = (from: () => Promise<Given[]> | Given[]): void => {
    trouble.value = null;
    void opening.open(from).then((said) => { if (said !== null) onSaid(said); });
  };
  const given = handed.value;
  useEffect(() => {
    if (given === null) return;
    handed.value = null;
    take(() => filesOf(given));
  }, [given]);
  const onOpen = (): void => file.current?.click();
  const problem = trouble.value;
  const messages = (
    <>
      {opening.doing.value && <p class="note" role="status">{opening.doing.value}</p>}
      {problem instanceof ServerProblem && <Trouble problem={problem} onClose={() => { trouble.value = null; }} />}
      {problem && !(problem instanceof ServerProblem) && <div class="note note-bad" role="alert"><p>{problem.text}</p>
        {problem.chooses && <Button onClick={onOpen}>{words.open.choose}</Button>}
        <Button kind="quiet" onClick={() => { trouble.value = null; }}>{words.close}</Button></div>}
    </>
  );
  const empty = desk.spec.value === null && desk.foreign.value === null;
  useEffect(() => { if (!empty) trouble.value = null; }, [empty]);
  return (
    <div class="design-drop">
      <input ref={file} type="file" class="visually-hidden" tabIndex={-1} aria-hidden="true" multiple
        accept=".json,.fold,.svg,.dxf,.pdf,.ai,.stl,.obj,.glb,.mtl,.zip,image/*"
        onChange={(event) => {
          const files = [...event.currentTarget.files ?? []];
          event.currentTarget.value = '';
          take(() => filesOf({ entries: [], files }));
        }} />
      <Questions onSaid={onSaid} />
      {empty ? <Start onOpen={onOpen}>{messages}</Start> : <>{messages}<Desk onOpen={onOpen} /></>}
    </div>
  );
}
