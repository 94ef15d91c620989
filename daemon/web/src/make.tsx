// SPDX-License-Identifier: MIT
// Make it: from the card on the desk to a sheet in somebody's hands, on whatever machine they have.
import { useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useEffect, useMemo } from 'preact/hooks';
import * as desk from './design_desk';
import { drawing, DrawingQuestion, mustAnswer, optionsOf } from './drawing';
import { Button, Dialog, Trouble } from './parts';
import { keepText, keptText, paper as ownPaper } from './preferences';
import { isProblem, saveAs, send, type ServerProblem } from './server';
import { can, devices, may, stale } from './store';
import { withoutTicks } from './words';
import { designWords } from './words_design';
import { makeWords as words } from './words_make';

interface MadeSheet { size_mm: [number, number]; cut_mm: number; fold_mm: number; picture: string }
interface MadeFile { name: string; type: string; text?: string; base64?: string; page_mm?: [number, number] }
interface Made { sheets: MadeSheet[]; files: MadeFile[]; handwork: string | null; warnings: string[]; command: string }

/** The papers of each way; the first is taken until somebody chooses. '' is the first mat of the machine. */
const kPapers: Record<string, string[]> = {
  hand: ['A4', 'letter', 'A3', '12x12in'],
  cricut: ['', '12x24', 'A4', 'letter'],
  silhouette: ['', '12x24', 'A4', 'letter'],
  laser: ['A4', 'letter', 'A3', '300x200', '600x400', '12x12in'],
};

const papersOf = (way: string, machine: string): string[] => (way !== 'cricut' || !machine.includes('joy') ? kPapers[way] ?? []
  : machine === 'cricut-joy' ? ['4.5x12', ''] : ['']);

function bytesOf(file: MadeFile): Blob {
  const { text, base64 = '', type } = file;
  const bytes = text === undefined ? Uint8Array.from(atob(base64), (c) => c.charCodeAt(0)) : text;
  return new Blob([bytes], { type });
}

/** A picture of a sheet, as an image: nothing in it can act. */
function SheetImage({ svg, alt }: { svg: string; alt: string }) {
  const address = useMemo(() => URL.createObjectURL(new Blob([svg], { type: 'image/svg+xml' })), [svg]);
  useEffect(() => () => URL.revokeObjectURL(address), [address]);
  return <img class="made-picture" src={address} alt={alt} />;
}

/** One way: its steps, its paper, its sheets and files. */
function Way({ way, name }: { way: string; name: string }) {
  const machine = useSignal(keptText('cricut') ?? 'cricut-maker');
  const papers = papersOf(way, machine.value);
  const stored = keptText(`paper.${way}`) ?? '';
  // What was chosen here, else what this person cuts on.
  const paper = useSignal([stored, ownPaper.peek()].find((one) => one !== '' && papers.includes(one)) ?? papers[0]!);
  const made = useSignal<Made | null>(null);
  const problem = useSignal<ServerProblem | null>(null);
  const answered = JSON.stringify(drawing.value?.question ?? null);
  useEffect(() => {
    const stop = new AbortController();
    made.value = null;
    problem.value = null;
    const make = async (): Promise<void> => {
      try {
        const design = await desk.storedId();
        const options = { ...optionsOf(design), ...(paper.value ? { mat: paper.value } : {}) };
        const body = { way, options, ...(way === 'cricut' ? { machine: machine.value } : {}) };
        const answer = await send<Made>('POST', `/v1/designs/${design}/make`, { body, signal: stop.signal });
        if (!stop.signal.aborted) made.value = answer;
      } catch (error) {
        if (stop.signal.aborted) return;
        if (!isProblem(error)) throw error;
        problem.value = error;
      }
    };
    if (!mustAnswer(desk.foreign.peek()?.id)) void make();
    return () => stop.abort();
  }, [way, paper.value, machine.value, answered]);
  const asked = desk.foreign.value && (mustAnswer(desk.foreign.value.id) || problem.value?.errors.some((one) => one.code === 'unclear'));
  const page = made.value?.files.find((file) => file.page_mm)?.page_mm;
  return (
    <div class="make-way">
     <div class="make-left">
      <ol class="make-steps">{Object.values(words.steps[way] ?? {}).map((step) => <li key={step}>{step}</li>)}
        {desk.lattice.value?.parts.length ? <li>{designWords.parts.glue}</li> : null}</ol>
      {way === 'silhouette' && <p class="muted small">{words.svgToo}</p>}
      <div class="field-grid">
        {way === 'cricut' && (
          <label class="field"><span>{words.machine}</span>
            <select value={machine.value} onChange={(event) => {
              machine.value = event.currentTarget.value;
              paper.value = papersOf(way, machine.value)[0]!;
              keepText('cricut', machine.value);
            }}>
              {Object.entries(words.cricuts).map(([id, title]) => <option key={id} value={id} selected={id === machine.value}>{title}</option>)}
            </select>
          </label>
        )}
        <label class="field"><span>{words.paper}</span>
          <select value={paper.value} onChange={(event) => { paper.value = event.currentTarget.value; keepText(`paper.${way}`, paper.value || null); }}>
            {papers.map((one) => <option key={one} value={one} selected={one === paper.value}>
              {one === '' && machine.value.includes('joy') && way === 'cricut' ? words.largestMat : words.papers[one]}</option>)}
          </select>
        </label>
      </div>
      {asked && <DrawingQuestion design={desk.foreign.value!.id} onAnswer={desk.readAgain} />}
      {problem.value && !asked && <Trouble problem={problem.value} />}
      {!made.value && !problem.value && !asked && <p class="muted" role="status">{words.making}</p>}
      {made.value && <>
        <div class="made-files">
          {made.value.files.map((file) => (
            <Button key={file.name} kind={file === made.value!.files[0] ? 'primary' : 'plain'}
              onClick={() => saveAs(bytesOf(file), `${name}-${file.name}`)}>{words.save(file.name)}</Button>
          ))}
        </div>
        {page && <p class="muted">{words.page(...page)}</p>}
        {made.value.handwork && <p>{made.value.handwork}</p>}
        {made.value.warnings.map((one) => <p key={one} class="note note-amber server-words">{withoutTicks(one)}</p>)}
        <p class="small muted">{words.command} <code>{made.value.command}</code></p>
      </>}
     </div>
      {made.value && (
        <div class="made-sheets">
          {made.value.sheets.map((sheet, k) => (
            <figure key={k}>
              {sheet.picture && <SheetImage svg={sheet.picture} alt={words.sheet(k + 1, made.value!.sheets.length)} />}
              <figcaption class="small"><strong>{words.sheet(k + 1, made.value!.sheets.length)}</strong>{' '}
                {words.sheetSize(...sheet.size_mm, sheet.cut_mm, sheet.fold_mm)}</figcaption>
            </figure>
          ))}
        </div>
      )}
    </div>
  );
}

/**
 * The chooser. `onCut` goes on with a connected cutter, with a printed picture or without; `children` are the other
 * formats.
 */
export function MakeDialog({ name, onCut, onClose, children }: {
  name: string; onCut: (printed: boolean) => void; onClose: () => void; children: ComponentChildren;
}) {
  const way = useSignal<string | null>(null);
  const off = !desk.canCut.value || stale.value;
  const here = devices.value.size > 0;
  const rows = Object.entries(words.ways).filter(([id]) => (id !== 'print' || desk.spec.value) && (id !== 'cut' || can('devices')));
  if (way.value) return (
    <Dialog title={words.ways[way.value]!.title} onNo={onClose} no={designWords.close} wide>
      <p><Button kind="quiet" onClick={() => { way.value = null; }}>{words.back}</Button></p>
      <Way way={way.value} name={name} />
    </Dialog>
  );
  return (
    <Dialog title={words.title} onNo={onClose} no={designWords.close} wide>
      {!desk.canCut.value && <p class="muted" role="status">{designWords.cut.wait}</p>}
      {may('submitter') && <ul class="make-ways">
        {rows.map(([id, said]) => {
          const cuts = id === 'cut' || id === 'print';
          const missing = cuts && !here && can('devices');
          const { title, what } = id === 'print' && !can('devices') ? words.printOnly : said;
          return (
            <li key={id}>
              <button type="button" class="make-choice" disabled={off || missing} onClick={() => (cuts ? onCut(id === 'print') : (way.value = id))}>
                <strong>{title}</strong><span>{missing ? words.noCutter : what}</span>
              </button>
            </li>
          );
        })}
      </ul>}
      <details class="make-more"><summary>{words.more}</summary>{children}</details>
    </Dialog>
  );
}
