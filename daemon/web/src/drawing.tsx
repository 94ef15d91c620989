// SPDX-License-Identifier: MIT
// What a drawing from another program does not say: what its lines are for, and its unit. The answers are kept for
// that drawing, and go along with every plan of it.
import { signal } from '@preact/signals';
import { useEffect, useId } from 'preact/hooks';
import { Button } from './parts';
import { keptText, keepText } from './preferences';
import { isProblem, send } from './server';
import { may } from './store';
import { size } from './words';
import { makeWords } from './words_make';

const words = makeWords.drawing;

export interface Look {
  name: string;
  option: 'layers' | 'colors';
  colour: string;
  length_mm: number;
  path: string;
  fold?: boolean;   // nobody must answer
  of?: Question;    // in whose scale its lines are
}
export interface Question {
  kind: string;
  size_mm: [number, number];
  unit: 'said' | 'guessed';
  asks: 'layers' | 'colors' | null;
  looks: Look[];
  folds: Look[];   // whose side the drawing does not say
  path: string;
}

interface Answers { uses: Record<'layers' | 'colors', Record<string, string>>; units: string }
const none = (): Answers => ({ uses: { layers: {}, colors: {} }, units: '' });

const kKept = 'drawings';
const kMostKept = 50;

function keptAnswers(): Record<string, Answers> {
  try {
    const all = JSON.parse(keptText(kKept) ?? '{}') as unknown;
    return typeof all === 'object' && all !== null ? all as Record<string, Answers> : {};
  } catch {
    return {};
  }
}

export function answersOf(design: string): Answers {
  const kept = keptAnswers()[design];
  return kept?.uses?.layers && kept.uses.colors ? kept : none();
}

function keep(design: string, answers: Answers): void {
  const all = keptAnswers();
  delete all[design];
  const rows = [...Object.entries(all), [design, answers] as const].slice(-kMostKept);
  keepText(kKept, JSON.stringify(Object.fromEntries(rows)));
}

const listed = (uses: Record<string, string>): string => Object.entries(uses).map(([name, use]) => `${name}=${use}`).join('; ');

/** The answers as options of planning. */
export function optionsOf(design: string): Record<string, string> {
  const { uses, units } = answersOf(design);
  const all = { layers: listed(uses.layers), colors: listed(uses.colors), units };
  return Object.fromEntries(Object.entries(all).filter(([, text]) => text !== ''));
}

/** The drawing on the desk, what it asks, and all looks that it asked about so far. */
export const drawing = signal<{ design: string; question: Question; looks: Look[] } | null>(null);

let turn = 0;

/** Reads what the drawing asks, with the answers so far. */
export async function ask(design: string): Promise<void> {
  const mine = ++turn;
  try {
    const question = await send<Question>('POST', `/v1/designs/${design}/make`, { body: { way: 'drawing', options: optionsOf(design) } });
    if (mine !== turn) return;   // another answer was given meanwhile
    const before = drawing.peek()?.design === design ? drawing.peek()!.looks : [];
    // Of several colours that nobody must explain some are dashed, and may be folds.
    const isOpen = question.asks === null;
    const shown = isOpen && (question.kind !== 'svg' || question.looks.length < 2) ? [] : question.looks;
    const fresh = [...shown.map((look) => ({ ...look, fold: isOpen })), ...(question.folds ?? []).map((look) => ({ ...look, fold: true }))]
      .filter((look) => !before.some((one) => one.name === look.name && one.option === look.option))
      .map((look) => ({ ...look, of: question }));
    drawing.value = { design, question, looks: [...before, ...fresh] };
  } catch (error) {
    if (!isProblem(error)) throw error;
  }
}

/** Whether the drawing `design` must be explained before it can be planned; null: there is none on the desk. */
export const mustAnswer = (design: string | null | undefined): boolean => drawing.value !== null && drawing.value.design === design
  && (drawing.value.question.asks !== null || drawing.value.question.unit === 'guessed');

/** What lines of a colour like this mostly are: greys are cut, reds mountain folds, blues valley folds; '' where nobody knows. */
export function usualUse(colour: string): string {
  if (!/^#[0-9a-f]{6}$/i.test(colour)) return '';
  const [r, g, b] = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16)) as [number, number, number];
  const [most, least] = [Math.max(r, g, b), Math.min(r, g, b)];
  if (most - least < 48) return most < 96 || least > 240 ? 'cut' : '';
  const clearly = 0.6 * most;
  if (r === most && g < clearly && b < clearly) return 'fold-mountain';
  return b === most && r < clearly ? 'fold-valley' : '';
}

/** What `looks` mostly are for: where no colour would be cut the longest is, and a single colour of folds does not tell their side. */
function guessedUses(looks: Look[], uses: Answers['uses']): Map<string, string> {
  const all = new Map(looks.map((look) => [look.name, uses[look.option][look.name] ?? usualUse(look.colour)]));
  const has = (use: string): string[] => [...all].filter(([, one]) => one.startsWith(use)).map(([name]) => name);
  if (has('cut').length === 0 && looks.length > 1 && looks.every((look) => look.option === 'colors')) {
    all.set([...looks].sort((a, b) => b.length_mm - a.length_mm)[0]!.name, 'cut');
  }
  const folds = has('fold');
  if (folds.length === 1) all.set(folds[0]!, 'fold');
  return all;
}

const shownName = ({ name, option }: Look): string => (option === 'colors' && words.colours[name.toLowerCase()]) || name;

function Thumbnail({ look, of }: { look: Look; of: Question }) {
  const [w, h] = of.size_mm.map((mm) => Math.max(mm, 1)) as [number, number];
  const line = Math.max(w, h) / 40;
  return (
    <svg class="look-picture" viewBox={`${-line} ${-line} ${w + 2 * line} ${h + 2 * line}`} aria-hidden="true">
      {[of.path, ...of.looks.map((one) => one.path)].map((path, i) => <path key={i} d={path} class="look-others" stroke-width={line / 2} />)}
      <path d={look.path} fill="none" stroke={/^#[0-9a-f]{6}$/i.test(look.colour) ? look.colour : 'currentColor'} stroke-width={line} />
    </svg>
  );
}

/** The question in place: swatches of lines, and the unit. */
export function DrawingQuestion({ design, onAnswer }: { design: string; onAnswer: (asked: Promise<void>) => Promise<void> }) {
  const id = useId();
  useEffect(() => { if (may('submitter')) void ask(design); }, [design]);
  const shown = drawing.value;
  if (shown === null || shown.design !== design) return null;
  const { question, looks } = shown;
  const answers = answersOf(design);
  const rows = [...looks, ...(['layers', 'colors'] as const).flatMap((option) => Object.keys(answers.uses[option])
    .filter((name) => !looks.some((look) => look.option === option && look.name === name))
    .map((name): Look => ({ name, option, colour: option === 'colors' ? name : '', length_mm: 0, path: '' })))];
  const answer = (change: (next: Answers) => void): void => {
    const next = answersOf(design);
    change(next);
    keep(design, next);
    void onAnswer(ask(design));
  };
  const guesses = guessedUses(rows.filter((look) => !look.fold), answers.uses);
  const useOf = (look: Look, uses = answers.uses): string => uses[look.option][look.name] ?? (question.asks === null || look.fold ? '' : guesses.get(look.name) ?? '');
  const isOpen = (fold: boolean): boolean => rows.some((look) => !look.fold !== fold && useOf(look) === '');
  const guessed = question.unit === 'guessed' || answers.units !== '';
  const unit_mm: Record<string, number> = { mm: 1, cm: 10, in: 25.4 };
  const one = unit_mm[answers.units] ?? 1;
  const options = optionsOf(design);
  return (
    <section class={mustAnswer(design) ? 'drawing-question drawing-asks' : 'drawing-question'} aria-labelledby={id}>
      <h2 id={id}>{question.asks ? words.title : question.unit === 'guessed' ? words.unit : words.done}</h2>
      {guessed ? (
        <fieldset class="units">
          <legend class={question.unit === 'guessed' && !question.asks ? 'visually-hidden' : ''}>{words.unit}</legend>
          {question.unit === 'guessed' && <p class="muted small units-what">{words.unitWhat}</p>}
          {Object.entries(words.units).map(([name, text]) => (
            <label key={name} class="tick">
              <input type="radio" name={`${id}-unit`} checked={answers.units === name} onChange={() => answer((next) => { next.units = name; })} />
              <span>{text}: {size(question.size_mm[0] / one * unit_mm[name]!, question.size_mm[1] / one * unit_mm[name]!)}</span>
            </label>
          ))}
        </fieldset>
      ) : <p class="muted">{words.size(...question.size_mm)}</p>}
      {rows.length > 0 && <>
        {question.asks && <p role="status">{words.what}</p>}
        {isOpen(true) && <p class="muted small">{rows.some((look) => look.fold && look.option === 'colors') ? words.dashes : words.sides}</p>}
        <ul class="plain-list looks">
          {rows.map((look) => (
            <li key={`${look.option} ${look.name}`}>
              <label class="look">
                {look.of ? <Thumbnail of={look.of} look={look} /> : <span class="look-picture" />}
                <span class="look-name">{look.of ? words.of(shownName(look), look.length_mm * question.size_mm[0] / look.of.size_mm[0]) : shownName(look)}</span>
                <select value={useOf(look)} onChange={(event) => {
                  const use = event.currentTarget.value;
                  answer((next) => {
                    if (use === '') delete next.uses[look.option][look.name];
                    else next.uses[look.option][look.name] = use;
                  });
                }}>
                  <option value="">{!look.fold ? words.choose : look.option === 'colors' ? words.asDrawn : words.anySide}</option>
                  {Object.entries(words.uses).filter(([use]) => use !== 'fold' || !look.fold || look.option === 'colors').map(([use, text]) => <option key={use} value={use} selected={useOf(look) === use}>{text}</option>)}
                </select>
              </label>
            </li>
          ))}
        </ul>
        {question.asks && <p><Button kind="primary" disabled={isOpen(false)}
          onClick={() => answer((next) => { for (const look of rows) if (!look.fold) next.uses[look.option][look.name] = useOf(look, next.uses); })}>{words.yes}</Button></p>}
      </>}
      {Object.keys(options).length > 0 && <details class="small muted"><summary>{words.option}</summary><code>{Object.entries(options).map(([name, text]) => `--${name} "${text}"`).join(' ')}</code></details>}
    </section>
  );
}
