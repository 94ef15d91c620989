// The sheet of a job as it lies on the mat, drawn from the plan's own strokes.
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Job, Ledger, Sheet } from './model';
import { Picture } from './parts';
import { isProblem, read } from './server';
import { SheetView, type Fates, type Strokes } from './sheet_view';

/** Which sheet of its plan a sheet of `job` is: each copy has the sheets of the plan again. */
export function sheetInPlan(job: Job, sheet: Sheet): number {
  const ofPlan = Math.max(1, Math.round(job.sheets_total / Math.max(1, job.copies)));
  return (sheet.sheet - 1) % ofPlan + 1;
}

/** What is known of a job's current sheet. `strokes` is null while it is read, and if popcutd has none. */
export interface SheetOfJob { sheet: Sheet | null; strokes: Strokes | null; missing: boolean }

/** Reads the current sheet of `job` and its strokes; again when another sheet is its turn. */
export function useSheet(job: Job): SheetOfJob {
  const [known, setKnown] = useState<SheetOfJob>({ sheet: null, strokes: null, missing: false });
  const { id, sheet: number, plan } = job;
  useEffect(() => {
    setKnown({ sheet: null, strokes: null, missing: false });
    if (number === null || plan === null) return;
    const stop = new AbortController();
    const all = async (): Promise<void> => {
      const sheet = await read<Sheet>(`/v1/jobs/${id}/sheets/${number}`, { signal: stop.signal });
      setKnown({ sheet, strokes: null, missing: false });
      const strokes = await read<Strokes>(`/v1/plans/${plan}/sheets/${sheetInPlan(job, sheet)}/strokes`, { signal: stop.signal });
      setKnown({ sheet, strokes, missing: false });
    };
    all().catch((error) => {
      if (isProblem(error)) setKnown((one) => ({ ...one, missing: true }));
    });
    return () => stop.abort();
  }, [id, number, plan]);
  return known;
}

/** Reads what became of each stroke; again when the job changes. */
export function useLedger(job: Job, wanted: boolean): Ledger | null {
  const [ledger, setLedger] = useState<Ledger | null>(null);
  const { id, sheet, rev } = job;
  useEffect(() => {
    if (!wanted || sheet === null) {
      setLedger(null);
      return;
    }
    const stop = new AbortController();
    read<Ledger>(`/v1/jobs/${id}/sheets/${sheet}/ledger`, { signal: stop.signal })
      .then(setLedger, () => undefined);
    return () => stop.abort();
  }, [id, sheet, rev, wanted]);
  return ledger;
}

/**
 * The picture. `fates` colours what became of the strokes, `marked` points at one, `lens` shows it at true size;
 * `onPick` gets the stroke that is tapped.
 */
export function SheetPicture({ job, known, fates, marked = null, lens = false, onPick, label }: {
  job: Job; known: SheetOfJob; fates: Fates | null; marked?: number | null; lens?: boolean;
  onPick?: (stroke: number) => void; label: string;
}) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const view = useRef<SheetView | null>(null);
  const shown = known.strokes !== null;
  useEffect(() => {
    if (!shown) return;
    const made = new SheetView(canvas.current!);
    view.current = made;
    return () => { made.dispose(); view.current = null; };
  }, [shown]);
  useEffect(() => { view.current?.setStrokes(known.strokes); }, [known.strokes]);
  useEffect(() => { view.current?.setFates(fates); }, [fates, known.strokes]);
  useEffect(() => {
    view.current?.setMarked(marked);
    view.current?.setLens(lens ? marked : null);
  }, [marked, lens, known.strokes]);
  const points = marked !== null && known.strokes !== null;
  useEffect(() => { if (points) view.current?.pulse(); }, [points]);
  useEffect(() => {
    if (view.current) view.current.onPick = onPick ? (stroke) => { if (stroke !== null) onPick(stroke); } : null;
  });
  if (known.missing && known.sheet && job.plan) {
    return <Picture path={`/v1/plans/${job.plan}/sheets/${sheetInPlan(job, known.sheet)}.svg`} alt={label} class="sheet-image" />;
  }
  return shown ? <canvas ref={canvas} class="sheet-canvas" role="img" tabIndex={0} aria-label={label} />
    : <div class="sheet-canvas sheet-none" />;
}
