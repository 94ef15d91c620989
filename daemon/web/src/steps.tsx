// SPDX-License-Identifier: MIT
// What views that go step by step share: their keys, and the card as it stands in a step.
import { useSignal } from '@preact/signals';
import { useEffect, useLayoutEffect, useRef } from 'preact/hooks';
import type { Lattice } from './lattice';
import { paintModel } from './model_paper';
import type { ModelView } from './model_view';
import { designWords } from './words_design';

/** Arrow keys and space go through `count` steps. */
export function useStepKeys(move: (by: number) => void, count: number): void {
  useLayoutEffect(() => {
    const onKey = (event: KeyboardEvent): void => {
      if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
      const on = event.target as HTMLElement;
      if (on.tagName === 'CANVAS' && event.key.startsWith('Arrow')) return;
      if ((on.tagName === 'BUTTON' || on.tagName === 'A') && event.key === ' ') return;
      if (on.tagName === 'INPUT' || on.tagName === 'SELECT') return;
      if (event.key === 'ArrowRight' || event.key === 'ArrowDown' || event.key === ' ') move(1);
      else if (event.key === 'ArrowLeft' || event.key === 'ArrowUp') move(-1);
      else return;
      event.preventDefault();
    };
    addEventListener('keydown', onKey);
    return () => removeEventListener('keydown', onKey);
  }, [count, move]);
}

/** A card that is open by `psi_rad`, its faces `lit`; it moves there from where it was. `side`: from where one looks at first. */
export function StepModel({ of, psi_rad, lit, side }: { of: Lattice; psi_rad: number; lit: ReadonlySet<number>; side?: 'right' | 'left' | undefined }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const view = useSignal<ModelView | null>(null);
  const paper = useSignal(false);
  useEffect(() => {
    let stopped = false;
    void import('./model_view').then(({ ModelView: View, hasWebgl }) => {
      if (stopped || !canvas.current) return;
      if (!hasWebgl()) {
        paper.value = true;
        return;
      }
      view.value = new View(canvas.current);
    });
    return () => {
      stopped = true;
      view.peek()?.dispose();
    };
  }, []);
  useEffect(() => { view.value?.setLattice(of); }, [view.value, of]);
  useEffect(() => {
    if (paper.value && canvas.current) paintModel(canvas.current, of, psi_rad, 'paper', lit);
    const made = view.value;
    if (!made) return undefined;
    made.markFaces(lit);
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) {
      made.setPsi(psi_rad);
      return undefined;
    }
    const from = made.psi_rad;
    const start = performance.now();
    let frame = 0;
    const tick = (now: number): void => {
      const share = Math.min(1, (now - start) / 700);
      made.setPsi(from + (psi_rad - from) * share * share * (3 - 2 * share));
      if (share < 1) frame = requestAnimationFrame(tick);
    };
    frame = requestAnimationFrame(tick);
    return () => cancelAnimationFrame(frame);
  }, [view.value, paper.value, of, psi_rad, lit]);
  useEffect(() => { if (side) view.value?.lookFrom(side); }, [view.value, lit, side]);
  return <canvas ref={canvas} key={paper.value ? 'paper' : 'model'} class="glue-canvas" role="img" tabIndex={0}
    aria-label={designWords.stage.sentence(of.name, of.faces, designWords.psi.text((psi_rad * 180) / Math.PI), null)} />;
}
