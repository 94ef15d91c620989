// SPDX-License-Identifier: MIT
// Glue: from the cut sheets to the card, one step a screen.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import { useAgain } from './again';
import { bands, fans, glueSteps, type GlueStep, type PlanFile } from './glue_steps';
import { readLattice, type Lattice } from './lattice';
import { Button, LinkButton, Loading, Trouble } from './parts';
import { foldOf } from './route';
import { isProblem, read, readBlob, readAnswer, type ServerProblem } from './server';
import { readStrokes, usePlan } from './sheets';
import { SheetView, type Strokes } from './sheet_view';
import { StepModel, useStepKeys } from './steps';
import { designWords } from './words_design';

const words = designWords.glue;
const kKept = 'popcut.glue.';
const kMostKept = 40;

function keptStep(plan: string): number {
  try {
    return Math.max(0, Math.floor(Number(localStorage.getItem(kKept + plan) ?? 0)) || 0);
  } catch {
    return 0;
  }
}

/** Keeps how far a plan is glued; the oldest of many plans are forgotten. */
function keepStep(plan: string, step: number): void {
  try {
    localStorage.setItem(kKept + plan, String(step));
    // Ids of plans grow with time.
    const keys = Object.keys(localStorage).filter((key) => key.startsWith(kKept)).sort();
    for (const key of keys.slice(0, Math.max(0, keys.length - kMostKept))) localStorage.removeItem(key);
  } catch {
    // without storage, progress is not kept
  }
}

export function stepTitle(step: GlueStep): string {
  switch (step.kind) {
    case 'waste': return words.waste;
    case 'mountains': return words.mountains;
    case 'valleys': return words.valleys;
    case 'seam': return words.seam(step.letter);
    case 'weight': return words.weight;
    case 'open': return words.open;
    case 'shape': return words.shape;
  }
}

function stepText(step: GlueStep, psi_deg: number): string {
  switch (step.kind) {
    case 'waste': return words.wasteWhat(step.sheets);
    case 'mountains': return words.mountainsWhat(step.folds);
    case 'valleys': return words.valleysWhat(step.folds);
    case 'seam': return words.seamWhat(step.letter, step.sides[0]?.piece ?? 1, step.sides[1]?.piece ?? 2);
    case 'weight': return words.weightWhat;
    case 'shape': return words.shapeWhat;
    case 'open': return words.openWhat(designWords.psi.text(psi_deg).replace(/^open /, ''));
  }
}

/** One sheet, with what this step needs lit. */
function StepSheet({ plan, sheet, step }: { plan: string; sheet: number; step: GlueStep }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const view = useRef<SheetView | null>(null);
  const strokes = useSignal<Strokes | null>(null);
  const missed = useSignal<ServerProblem | null>(null);
  useEffect(() => {
    if (!canvas.current) return undefined;
    const made = new SheetView(canvas.current);
    made.setOptions({ feedEdge: false, mat: false });
    view.current = made;
    return () => made.dispose();
  }, []);
  useEffect(() => {
    let wanted = true;
    missed.value = null;
    readStrokes(plan, sheet).then((got) => { if (wanted) strokes.value = got; },
      (error: unknown) => { if (wanted && isProblem(error)) missed.value = error; });
    return () => { wanted = false; };
  }, [plan, sheet, useAgain(missed.value)]);
  useEffect(() => {
    const made = view.current;
    if (!made) return;
    made.setStrokes(strokes.value);
    made.setOptions({ only: step.kind === 'mountains' ? ['mountain'] : step.kind === 'valleys' ? ['valley'] : step.kind === 'waste' ? ['cut'] : null });
    const sides = step.kind === 'seam' ? step.sides.filter((side) => side.sheet === sheet) : [];
    made.setLit(sides.length > 0 ? concat(bands(sides.flatMap((side) => side.edges), 3), fans(sides.flatMap((side) => side.tabs))) : null);
    made.setShadow(sides.some((side) => side.shadows.length > 0) ? fans(sides.flatMap((side) => side.shadows)) : null);
  }, [strokes.value, step, sheet]);
  return <canvas ref={canvas} class="glue-canvas" role="img" tabIndex={0} data-strokes={strokes.value?.stroke.points.length ?? ''}
    aria-label={`${designWords.sheets.picture(sheet)}: ${stepTitle(step)}`} />;
}

function concat(a: Float32Array, b: Float32Array): Float32Array {
  const out = new Float32Array(a.length + b.length);
  out.set(a);
  out.set(b, a.length);
  return out;
}

/** Faces that touch a seam, by the pattern's own coordinates. */
function seamFaces(of: Lattice, plan: PlanFile, step: GlueStep): Set<number> {
  const out = new Set<number>();
  if (step.kind !== 'seam') return out;
  for (const side of step.sides) {
    const transform = plan.sheets[side.sheet - 1]?.pieces?.find((one) => one.piece === side.piece)?.transform;
    if (!transform) continue;
    const [[a, b, c], [d, e, f]] = transform;
    for (let t = 0; t < of.triangle_face.length; t++) {
      for (let k = 0; k < 3; k++) {
        const p = 3 * (of.triangles[3 * t + k] as number);
        const v = of.points[p + 2] as number;
        const u = (of.points[p] as number) + of.card.wall_mm - (of.points[p + 1] as number);
        const x = a * v + b * u + c;
        const y = d * v + e * u + f;
        for (const line of side.edges) {
          for (let i = 1; i < line.length; i++) {
            const [ax, ay] = line[i - 1] as [number, number];
            const [bx, by] = line[i] as [number, number];
            const length = Math.hypot(bx - ax, by - ay) || 1;
            const along = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length;
            const across = Math.abs((x - ax) * (by - ay) - (y - ay) * (bx - ax)) / length;
            if (across < 0.3 && along > -0.3 && along < length + 0.3) out.add(of.triangle_face[t] as number);
          }
        }
      }
    }
  }
  return out;
}

/** How far the card is open in this step, rad. */
function psiOf(of: Lattice, step: GlueStep): number {
  if (step.kind === 'weight') return 0.12;
  return step.kind === 'seam' || step.kind === 'open' ? of.design_psi_rad : step.kind === 'waste' ? Math.PI : 2.5;
}

function sheetsOfStep(step: GlueStep, total: number): number[] {
  if (step.kind === 'seam') return [...new Set(step.sides.map((side) => side.sheet))];
  if (step.kind === 'weight' || step.kind === 'open') return [];
  return Array.from({ length: Math.min(total, 4) }, (_, i) => i + 1);
}

/** All steps and all sheets, for paper. */
function Printed({ name, steps, pictures, psi_deg }: { name: string; steps: GlueStep[]; pictures: string[]; psi_deg: number }) {
  return (
    <div class="glue-print">
      <h1>{`${words.title}: ${name}`}</h1>
      <ol>
        {steps.map((step, i) => <li key={i}><h2>{stepTitle(step)}</h2><p>{stepText(step, psi_deg)}</p></li>)}
      </ol>
      {pictures.map((address, i) => <figure key={address}><img src={address} alt={designWords.sheets.picture(i + 1)} /><figcaption>{designWords.sheets.picture(i + 1)}</figcaption></figure>)}
    </div>
  );
}

/** `#/glue/PLAN` */
export default function Glue({ rest: id }: { rest: string }) {
  const { plan, problem } = usePlan(id);
  const file = useSignal<PlanFile | null>(null);
  const folds = useSignal<{ mountains: number; valleys: number } | null>(null);
  const lattice = useSignal<Lattice | null>(null);
  const step = useSignal(keptStep(id));
  const trouble = useSignal<ServerProblem | null>(null);
  const pictures = useSignal<string[]>([]);
  const box = useRef<HTMLDivElement>(null);
  const ready = plan?.state === 'planned';
  useEffect(() => {
    if (!ready || !plan) return;
    trouble.value = null;
    read<PlanFile>(`/v1/plans/${encodeURIComponent(id)}/plan.json`).then((got) => { file.value = got; }, (error: unknown) => { if (isProblem(error)) trouble.value = error; });
    readAnswer(`/v1/designs/${encodeURIComponent(plan.design)}/lattice`, { accept: 'application/vnd.popcut.lattice' })
      .then(async (answer) => {
        const of = readLattice(await answer.arrayBuffer());
        lattice.value = of;
        let [mountains, valleys] = [0, 0];
        for (const role of of.line_role) {
          if (role === 2) mountains++;
          if (role === 3) valleys++;
        }
        folds.value = { mountains, valleys };
      }).catch((error: unknown) => {
        // A design that cannot be drawn has no count of its folds; one that could not be read is read again.
        if (isProblem(error) && [0, 401, 429].includes(error.status)) trouble.value = error;
        else folds.value = { mountains: 0, valleys: 0 };
      });
  }, [ready, id, useAgain(trouble.value)]);
  // Only a card is pressed shut: the net of a box, say, moves in more than one way.
  const of = lattice.value;
  const shuts = !of || of.card.card || (of.motion === 'frames' && !of.warnings.some(({ code }) => code === 'many_ways'));
  // A card of several parts has a guide of its own for all that comes after the pieces of its pages.
  const ofParts = (of?.parts.length ?? 0) > 0;
  const steps = file.value && folds.value ? glueSteps(file.value, ofParts ? { mountains: 0, valleys: 0 } : folds.value, shuts) : [];
  const count = steps.length;
  const move = (by: number): void => {
    step.value = Math.max(0, Math.min(count - 1, step.value + by));
    keepStep(id, step.value);
  };
  useStepKeys(move, count);
  if (problem ?? trouble.value) return <Trouble problem={(problem ?? trouble.value) as ServerProblem} />;
  if (plan?.state === 'failed') return <p class="note note-bad">{designWords.sheets.failed}</p>;
  if (!plan || count === 0) return <Loading />;
  const at = Math.min(step.value, count - 1);
  const now = steps[at] as GlueStep;
  const psi_deg = ((lattice.value?.design_psi_rad ?? Math.PI / 2) * 180) / Math.PI;
  const sheets = sheetsOfStep(now, file.value?.sheets.length ?? 0);
  const print = async (): Promise<void> => {
    if (pictures.value.length === 0) {
      const made: string[] = [];
      for (let k = 1; k <= Math.min(file.value?.sheets.length ?? 0, 20); k++) {
        made.push(URL.createObjectURL(await readBlob(`/v1/plans/${encodeURIComponent(id)}/sheets/${k}.svg`)));
      }
      pictures.value = made;
      await new Promise((done) => setTimeout(done, 300));
    }
    window.print();
  };
  return (
    <>
      <div class="glue glue-screen" ref={box}>
        <div class="row row-between">
          <div>
            <p class="muted figure">{words.step(at + 1, count)}</p>
            <h1 class="visually-hidden">{words.title}</h1>
          </div>
          <div class="row">
            <Button kind="quiet" onClick={() => { step.value = 0; keepStep(id, 0); }}>{words.restart}</Button>
            <Button kind="quiet" onClick={() => void print()}>{words.print}</Button>
            <LinkButton kind="quiet" href={`#/sheets/${id}`}>{words.toSheets}</LinkButton>
          </div>
        </div>
        <ol class="glue-dots" aria-hidden="true">{steps.map((_, i) => <li key={i} class={i <= at ? 'glue-dot glue-dot-done' : 'glue-dot'} />)}</ol>
        <div class="glue-step">
          <div class={sheets.length + (now.kind === 'seam' ? 1 : 0) > 1 ? `glue-pictures glue-two${sheets.length > 1 ? ' glue-pair' : ''}` : 'glue-pictures'}>
            {sheets.map((sheet) => <StepSheet key={sheet} plan={id} sheet={sheet} step={now} />)}
            {lattice.value && file.value && (now.kind === 'seam' || sheets.length === 0) && <StepModel of={lattice.value} psi_rad={psiOf(lattice.value, now)} lit={seamFaces(lattice.value, file.value, now)} />}
          </div>
          <div class="glue-text" aria-live="polite">
            <h2>{stepTitle(now)}</h2>
            <p>{stepText(now, psi_deg)}</p>
            <p class="muted small">{words.keys}</p>
          </div>
        </div>
        <div class="glue-acts">
          <Button big onClick={() => move(-1)} disabled={at === 0}>{words.back}</Button>
          {at + 1 < count
            ? <Button big kind="primary" onClick={() => move(1)}>{words.next}</Button>
            : ofParts ? <LinkButton big kind="primary" href={foldOf(plan.design)}>{designWords.sheets.fold}</LinkButton>
              : <LinkButton big kind="primary" href="#/">{words.done}</LinkButton>}
        </div>
      </div>
      <Printed name={file.value?.name ?? ''} steps={steps} pictures={pictures.value} psi_deg={psi_deg} />
    </>
  );
}
