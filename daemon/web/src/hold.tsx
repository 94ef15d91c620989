// A button that acts only when it is held: what moves a knife.
import { useEffect, useRef, useState } from 'preact/hooks';
import { Dialog } from './parts';
import { words } from './words';

/** How long it takes to start, and how long the button is inert after it appears, ms. */
export const kHold_ms = 800;
export const kInert_ms = 600;

interface HoldProps {
  children: preact.ComponentChildren;
  onHeld: () => void;
  question: { title: string; text: string; yes: string };   // for keyboard, switch and reader
  disabled?: boolean;
}

/** A ring fills while a pointer holds the button; leaving it, a second finger, a key, or losing the page cancels. */
export function HoldButton({ children, onHeld, question, disabled = false }: HoldProps) {
  const button = useRef<HTMLButtonElement>(null);
  const [inert, setInert] = useState(true);
  const [holding, setHolding] = useState(false);
  const [asks, setAsks] = useState(false);
  const [tooShort, setTooShort] = useState(false);
  const held = useRef<{ pointer: number; since: number; timer: ReturnType<typeof setTimeout> } | null>(null);
  const off = inert || disabled;

  const stop = (): void => {
    if (held.current) clearTimeout(held.current.timer);
    held.current = null;
    setHolding(false);
  };

  useEffect(() => {
    const timer = setTimeout(() => setInert(false), kInert_ms);
    const lost = (): void => stop();
    const second = (event: PointerEvent): void => {
      if (held.current && event.pointerId !== held.current.pointer) stop();
    };
    addEventListener('blur', lost);
    addEventListener('scroll', lost, true);
    addEventListener('resize', lost);
    addEventListener('keydown', lost, true);
    document.addEventListener('visibilitychange', lost);
    document.addEventListener('pointerdown', second, true);
    return () => {
      clearTimeout(timer);
      stop();
      removeEventListener('blur', lost);
      removeEventListener('scroll', lost, true);
      removeEventListener('resize', lost);
      removeEventListener('keydown', lost, true);
      document.removeEventListener('visibilitychange', lost);
      document.removeEventListener('pointerdown', second, true);
    };
  }, []);
  useEffect(() => { if (disabled) stop(); }, [disabled]);

  const inside = (event: PointerEvent): boolean => {
    const box = button.current!.getBoundingClientRect();
    return event.clientX >= box.left && event.clientX <= box.right
      && event.clientY >= box.top && event.clientY <= box.bottom;
  };

  const down = (event: PointerEvent): void => {
    if (off || held.current || event.button !== 0 || !event.isPrimary) return;
    const pointer = event.pointerId;
    button.current!.setPointerCapture?.(pointer);
    const since = performance.now();
    const check = (): void => {
      if (held.current?.pointer !== pointer) return;
      const rest = kHold_ms - (performance.now() - since);
      if (rest > 0) {
        held.current.timer = setTimeout(check, rest);
        return;
      }
      stop();
      onHeld();
    };
    held.current = { pointer, since, timer: setTimeout(check, kHold_ms) };
    setHolding(true);
    setTooShort(false);
  };

  const up = (): void => {
    if (held.current) setTooShort(true);
    stop();
  };

  const moved = (event: PointerEvent): void => {
    if (held.current?.pointer === event.pointerId && !inside(event)) stop();
  };

  return (
    <>
      <button ref={button} type="button" class={`hold${holding ? ' hold-on' : ''}`}
        disabled={off} tabIndex={0}
        onPointerDown={down} onPointerMove={moved} onPointerUp={up} onPointerCancel={stop}
        onLostPointerCapture={stop} onContextMenu={(event) => event.preventDefault()}
        onClick={(event) => { if (event.detail === 0 && !off) setAsks(true); }}>
        <svg class="hold-ring" viewBox="0 0 100 100" aria-hidden="true">
          <circle class="hold-track" cx="50" cy="50" r="46" />
          <circle class="hold-fill" cx="50" cy="50" r="46" pathLength={1} />
        </svg>
        <span class="hold-label">{children}</span>
      </button>
      {tooShort && !holding && !off && <p class="hold-hint" role="status">{words.machine.holdOn}</p>}
      {asks && !disabled && (
        <Dialog title={question.title} yes={question.yes} onNo={() => setAsks(false)}
          onYes={() => { setAsks(false); onHeld(); }}>
          <p>{question.text}</p>
        </Dialog>
      )}
    </>
  );
}
