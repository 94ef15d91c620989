// SPDX-License-Identifier: MIT
// A drawing that a person brings nearer: with the wheel, two fingers, buttons or keys, and moves while it is near.
import { useSignal } from '@preact/signals';
import { useEffect, useRef } from 'preact/hooks';
import type { Box } from './fold_guide';

const kNearest = 12;
const kStep = 1.5;
const kWheel = 1 / 300;

/** `whole` brought nearer by `factor` about the place (x, y), and never beyond its edges. */
export function nearer(whole: Box, shown: Box, factor: number, x: number, y: number): Box {
  const width = Math.min(whole[2], Math.max(whole[2] / kNearest, shown[2] / factor));
  const by = width / shown[2];
  return within(whole, [x + (shown[0] - x) * by, y + (shown[1] - y) * by, width, shown[3] * by]);
}

function within(whole: Box, [left, top, width, height]: Box): Box {
  const clamp = (at: number, least: number, room: number): number => Math.min(least + Math.max(0, room), Math.max(least, at));
  return [clamp(left, whole[0], whole[2] - width), clamp(top, whole[1], whole[3] - height), width, height];
}

/** What of `whole` is shown, and the handlers of the element that shows it; a new `subject` is shown whole. */
export function useZoom(whole: Box, subject: unknown) {
  const near = useSignal<Box | null>(null);
  const element = useRef<SVGSVGElement>(null);
  const held = useRef(new Map<number, [number, number]>());
  const known = useRef(whole);
  known.current = whole;
  const shown = near.value ?? whole;
  useEffect(() => { near.value = null; }, [subject]);
  const place = (x: number, y: number): [number, number] => {
    const matrix = element.current?.getScreenCTM();
    if (!matrix) return [0, 0];
    const { x: u, y: v } = new DOMPoint(x, y).matrixTransform(matrix.inverse());
    return [u, v];
  };
  const set = (next: Box): void => { near.value = next[2] >= 0.999 * known.current[2] ? null : next; };
  const zoom = (factor: number, at?: [number, number]): void => {
    const now = near.peek() ?? known.current;
    set(nearer(known.current, now, factor, ...(at ?? [now[0] + now[2] / 2, now[1] + now[3] / 2])));
  };
  useEffect(() => {
    const of = element.current;
    const onWheel = (event: WheelEvent): void => {
      event.preventDefault();
      zoom(Math.exp(-event.deltaY * kWheel), place(event.clientX, event.clientY));
    };
    of?.addEventListener('wheel', onWheel, { passive: false });
    return () => of?.removeEventListener('wheel', onWheel);
  }, []);
  const onPointerMove = (event: PointerEvent): void => {
    const before = held.current.get(event.pointerId);
    if (!before) return;
    const others = [...held.current].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
    const now: [number, number] = [event.clientX, event.clientY];
    held.current.set(event.pointerId, now);
    const [other] = others;
    if (other) {
      const apart = (at: [number, number]): number => Math.hypot(at[0] - other[0], at[1] - other[1]);
      zoom(apart(now) / Math.max(1, apart(before)), place((now[0] + other[0]) / 2, (now[1] + other[1]) / 2));
    } else if (near.peek()) {
      const [a, b] = [place(...before), place(...now)];
      const at = near.peek() as Box;
      set(within(known.current, [at[0] + a[0] - b[0], at[1] + a[1] - b[1], at[2], at[3]]));
    }
  };
  const letGo = (event: PointerEvent): void => { held.current.delete(event.pointerId); };
  return {
    shown, isNear: near.value !== null, closer: () => zoom(kStep), farther: () => zoom(1 / kStep),
    handlers: {
      ref: element, onPointerMove, onPointerUp: letGo, onPointerCancel: letGo,
      onPointerDown: (event: PointerEvent) => {
        held.current.set(event.pointerId, [event.clientX, event.clientY]);
        if (near.peek() || held.current.size > 1) element.current?.setPointerCapture(event.pointerId);
      },
    },
  };
}
