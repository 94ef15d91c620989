// SPDX-License-Identifier: MIT
// Fold: how a person folds a design, one step a screen, from its fold-guide.json.
import { useSignal } from '@preact/signals';
import { useEffect, useMemo } from 'preact/hooks';
import { useAgain } from './again';
import * as desk from './design_desk';
import { facesOnSheet, sheetBox } from './design_panel';
import { boxAround, cardsOfParts, pathOf, stepsOf, trianglesPath, type Box, type Guide, type GuideCard, type GuideFold, type GuideStep, type PartsGuide, type Point } from './fold_guide';
import { readLattice, Role, type Lattice, type Part } from './lattice';
import { Button, LinkButton, Loading, Trouble } from './parts';
import { isOn, onlyParts, partNamed } from './parts_card';
import { isProblem, read, readAnswer, readBlob, saveAs, type ServerProblem } from './server';
import { StepModel, useStepKeys } from './steps';
import { useZoom } from './zoom';
import { designWords } from './words_design';

const words = designWords.fold;
const kKept = 'popcut.fold';
const kWhole = 0.03, kNear = 0.25;   // margin around the sheet and around a step, as a share of them
const kBetween_mm = 10;              // between the sheets of parts
const kAsGlued = 0.9;               // of its opening: how far a card of several parts is open as it is glued
const kShutting_rad = 1.2;           // how far a card is open that is being pushed

/** Where a person was in the guide of a design; that of one design is kept. */
function keptStep(id: string): number {
  try {
    const kept = JSON.parse(sessionStorage.getItem(kKept) ?? 'null') as { id?: unknown; step?: unknown } | null;
    return kept?.id === id && typeof kept.step === 'number' ? kept.step : 0;
  } catch {
    return 0;
  }
}

function keepStep(id: string, step: number): void {
  try {
    sessionStorage.setItem(kKept, JSON.stringify({ id, step }));
  } catch {
    // without storage, the step is not kept
  }
}

/** Cuts and borders of a lattice on its sheet, or of some of its parts. */
function cutsOf(of: Lattice, parts: readonly Part[]): [Point, Point][] {
  const out: [Point, Point][] = [];
  of.line_role.forEach((role, i) => {
    if (role !== Role.cut && role !== Role.slit) return;
    const [u0, v0, u1, v1] = of.lines.subarray(4 * i, 4 * i + 4) as unknown as [number, number, number, number];
    if (parts.length > 0 && !parts.some((part) => isOn(part, u0, v0))) return;
    out.push([[u0, v0], [u1, v1]]);
  });
  return out;
}

const ends = (folds: readonly GuideFold[]): Point[] => folds.flatMap(({ from, to }) => [from, to]);
const linesOf = (folds: readonly GuideFold[]): [Point, Point][] => folds.map(({ from, to }) => [from, to]);

/** The sheet of a card: the folds of a step drawn strongly, its panels lit. Without `of`, it shows folds alone. */
function StepSheet({ card, step, of, near }: { card: GuideCard; step: GuideStep; of: Lattice | null; near: boolean }) {
  const sheet = useMemo(() => {
    const told = step.tabs ?? [];
    // Of a card of several parts, those that this step is about, side by side.
    const parts = of?.parts.filter((part) => part.name === card.name || told.some(({ outline: [at] }) => at && isOn(part, ...at))) ?? [];
    const lefts = parts.map((_, k) => parts.slice(0, k).reduce((sum, part) => sum + part.box_mm[2] + kBetween_mm, 0));
    const moved = (at: Point): Point => {
      const k = parts.findIndex((part) => isOn(part, ...at));
      const part = parts[k];
      return part ? [at[0] - part.box_mm[1], at[1] - part.box_mm[0] + (lefts[k] as number)] : at;
    };
    const folds = card.folds.map((fold) => ({ ...fold, from: moved(fold.from), to: moved(fold.to) }));
    const tabs = told.map((tab) => ({ ...tab, outline: tab.outline.map(moved) }));
    if (!of) return { box: boxAround(ends(folds), kWhole), paper: null, cuts: '', folds, tabs };
    const [left, top, width, height] = sheetBox(of);
    const corners = parts.length === 0 ? [[top, left], [top + height, left + width]] as Point[]
      : parts.flatMap(({ box_mm: [x, y, w, h] }) => [moved([y, x]), moved([y + h, x + w])]);
    return {
      box: boxAround(corners, kWhole), folds, tabs,
      paper: of.card.card ? { left, top, width, height } : null, cuts: pathOf(cutsOf(of, parts).map(([a, b]): [Point, Point] => [moved(a), moved(b)])),
    };
  }, [of, card, step]);
  const { tabs } = sheet;
  const own = step.folds.map((k) => sheet.folds[k]).filter((fold) => fold !== undefined);
  const others = useMemo(() => pathOf(linesOf(sheet.folds)), [sheet]);
  const corners = of ? facesOnSheet(of, step.panels) : new Float32Array();
  const at: Point[] = [...ends(own), ...tabs.flatMap(({ outline }) => outline)];
  if (own.length === 0) for (let i = 0; i + 1 < corners.length; i += 2) at.push([corners[i + 1] as number, corners[i] as number]);
  const box = (near ? boxAround(at, kNear) : null) ?? sheet.box ?? [0, 0, 100, 100];
  const { shown, isNear, closer, farther, handlers } = useZoom(box as Box, `${near} ${step.words} ${step.folds.join(' ')}`);
  const of_sense = (sense: GuideFold['sense']): GuideFold[] => own.filter((fold) => fold.sense === sense);
  const [mountains, valleys] = [of_sense('mountain'), of_sense('valley')];
  const said = [words.kinds[step.kind] ?? '', mountains.length > 0 && words.mountains(mountains.length), valleys.length > 0 && words.valleys(valleys.length)]
    .filter(Boolean).join(', ');
  return (
    <figure>
      <svg class={isNear ? 'fold-sheet fold-near' : 'fold-sheet'} viewBox={shown.join(' ')} role="img" aria-label={words.sheet(said)} {...handlers}>
        {sheet.paper && <rect class="fold-paper" x={sheet.paper.left} y={sheet.paper.top} width={sheet.paper.width} height={sheet.paper.height} />}
        <path class="fold-lit" d={trianglesPath(corners)} />
        {tabs.map(({ letter, outline, isPlace }) => {
          const [u, v] = [0, 1].map((k) => outline.reduce((sum, p) => sum + (p[k] as number), 0) / outline.length) as Point;
          return <g key={`${letter}${isPlace}`} class="fold-tab">
            <path class={isPlace ? 'fold-place' : 'fold-lit'} d={`M${outline.map(([y, x]) => `${x} ${y}`).join('L')}Z`} />
            <text x={v} y={u} text-anchor="middle" dominant-baseline="central">{letter}</text>
          </g>;
        })}
        <path class="fold-other" d={others} />
        <path class={step.kind === 'waste' ? 'fold-cuts fold-cuts-strong' : 'fold-cuts'} d={sheet.cuts} />
        <path class="fold-mountain" d={pathOf(linesOf(mountains))} />
        <path class="fold-valley" d={pathOf(linesOf(valleys))} />
      </svg>
      <figcaption class="fold-key">
        {mountains.length > 0 && <span class="fold-mountain">{words.mountains(mountains.length)}</span>}
        {valleys.length > 0 && <span class="fold-valley">{words.valleys(valleys.length)}</span>}
        {of && step.panels.length > 0 && <span class="muted">{words.panels(step.panels.length)}</span>}
        <span class="fold-zoom">
          <Button onClick={farther} disabled={!isNear} label={words.farther}>−</Button>
          <Button onClick={closer} label={words.closer}>+</Button>
        </span>
      </figcaption>
    </figure>
  );
}

/** `#/fold/DESIGN` */
export default function Fold({ rest: id }: { rest: string }) {
  const read_ = useSignal<Guide | PartsGuide | null>(null);
  const lattice = useSignal<Lattice | null>(null);
  const at = useSignal(keptStep(id));
  const near = useSignal(matchMedia('(max-width: 40rem)').matches);   // on a phone a whole sheet is small
  const trouble = useSignal<ServerProblem | null>(null);
  const address = `/v1/designs/${encodeURIComponent(id)}`;
  useEffect(() => {
    const stop = new AbortController();
    const missed = (error: unknown): void => {
      if (!stop.signal.aborted && isProblem(error)) trouble.value = error;
    };
    read_.value = null;
    lattice.value = null;
    trouble.value = null;
    read<Guide | PartsGuide>(`${address}/files/fold-guide.json`, { signal: stop.signal }).then((got) => { read_.value = got; }, missed);
    readAnswer(`${address}/lattice`, { accept: 'application/vnd.popcut.lattice', signal: stop.signal })
      .then(async (answer) => { lattice.value = readLattice(await answer.arrayBuffer()); }).catch(missed);
    return () => stop.abort();
  }, [id, useAgain(trouble.value)]);
  const whole = lattice.value;
  const { guide, steps } = useMemo(() => {
    const got = read_.value;
    if (!got || !whole) return { guide: null, steps: [] };
    return 'parts' in got ? cardsOfParts(got, whole.parts) : { guide: got, steps: stepsOf(got) };
  }, [read_.value, whole]);
  const now = steps[Math.max(0, Math.min(steps.length - 1, at.value))];
  // Of a card of several parts one sees what is there, and what comes now is lit.
  const shown = useMemo(() => {
    const names = now?.step.kind === 'fold' ? [guide?.cards[now.card]?.name ?? ''] : now?.step.standing ?? [];
    return whole && whole.parts.length > 0 ? onlyParts(whole, new Set(names.map((name) => partNamed(whole, name)))) : whole;
  }, [whole, now]);
  const lit = useMemo(() => {
    const added = new Set(now?.step.added?.map((name) => (whole ? partNamed(whole, name) : -1)));
    return new Set([...now?.step.panels ?? [], ...(whole ? [...whole.face_part.keys()].filter((f) => added.has(whole.face_part[f] as number)) : [])]);
  }, [whole, now]);
  const go = (to: number): void => {
    at.value = Math.max(0, Math.min(steps.length - 1, to));
    keepStep(id, at.value);
  };
  const move = (by: number): void => go(Math.min(at.value, steps.length - 1) + by);
  useStepKeys(move, steps.length);
  if (trouble.value) return <Trouble problem={trouble.value} />;
  if (guide && steps.length === 0) return <p class="note">{words.nothing}</p>;
  if (!guide || !now || !whole || !shown) return <Loading />;
  const { cards } = guide;
  const ofParts = whole.parts.length > 0;
  const card = cards[now.card] as GuideCard;
  const k = steps.indexOf(now);
  // In a lattice of a book all its cards lie side by side, and its faces have other numbers.
  const of = cards.length === 1 || ofParts ? whole : null;
  const psi_rad = now.step.kind === 'push' ? kShutting_rad : (ofParts ? kAsGlued : 1) * (whole.design_psi_rad || Math.PI / 2);
  const back = desk.spec.value ? '#/design' : `#/design/${id}`;   // the one on the desk, as it is
  const save = async (): Promise<void> => {
    try {
      saveAs(await readBlob(`${address}/files/fold-guide.json`), `${card.name || 'design'}-fold-guide.json`);
    } catch (error) {
      if (!isProblem(error)) throw error;
      trouble.value = error;
    }
  };
  return (
    <div class="glue fold">
      <div class="row row-between">
        <div>
          <p class="muted figure">{words.step(k + 1, steps.length)}</p>
          <h1 class="visually-hidden">{words.title}</h1>
        </div>
        <Button kind="quiet" onClick={() => { near.value = !near.value; }}>{near.value ? words.whole : words.near}</Button>
      </div>
      <div class="glue-step">
        <div class="glue-pictures">
          <StepSheet card={card} step={now.step} of={of} near={near.value} />
        </div>
        <div class="glue-text fold-text">
          <div aria-live="polite">
            {cards.length > 1 && !ofParts && <p class="muted">{words.card(card.name, now.card + 1, cards.length)}</p>}
            <h2>{words.kinds[now.step.kind] ?? ''}</h2>
            <p class="server-words">{now.step.words}</p>
          </div>
          {of && of.motion !== 'flat' && <StepModel of={shown} psi_rad={psi_rad} lit={lit} side={now.step.look_from} />}
        </div>
      </div>
      <div class="glue-acts fold-acts">
        <Button big onClick={() => move(-1)} disabled={k === 0}>{words.back}</Button>
        {k + 1 < steps.length
          ? <Button big kind="primary" onClick={() => move(1)}>{words.next}</Button>
          : <LinkButton big kind="primary" href={back}>{words.done}</LinkButton>}
      </div>
      <div class="row row-between">
        <p class="muted small">{words.keys}</p>
        <div class="row">
          <Button kind="quiet" onClick={() => go(0)}>{words.restart}</Button>
          <Button kind="quiet" onClick={() => void save()}>{words.save}</Button>
          <LinkButton kind="quiet" href={back}>{words.toDesign}</LinkButton>
        </div>
      </div>
    </div>
  );
}
