// The touch or key that wakes a screen must not press what happens to lie under it.

const kSwallow_ms = 800;

/**
 * Swallows the first touch, click or key within 0.8 s after the page became visible, with all that belongs to it.
 * PAUSE is exempt: stopping a knife is always meant.
 */
export function swallowWaking(): void {
  let until = 0;
  let swallowing: 'pointer' | 'key' | null = null;
  document.addEventListener('visibilitychange', () => {
    if (document.visibilityState !== 'visible') return;
    until = performance.now() + kSwallow_ms;
    swallowing = null;
  });
  const safe = (event: Event): boolean => (event.target instanceof Element && event.target.closest('[data-safe]') !== null)
    || (event instanceof KeyboardEvent && event.key === 'p');
  const swallow = (event: Event): void => {
    event.preventDefault();
    event.stopImmediatePropagation();
  };
  const first = (kind: 'pointer' | 'key') => (event: Event): void => {
    if (swallowing === kind) {
      if (event instanceof KeyboardEvent && event.repeat) return swallow(event);
      swallowing = null;
    }
    if (safe(event) || performance.now() >= until) return;
    until = 0;
    swallowing = kind;
    swallow(event);
  };
  const rest = (kind: 'pointer' | 'key', last: string) => (event: Event): void => {
    if (swallowing !== kind) return;
    swallow(event);
    if (event.type === last) swallowing = null;
  };
  addEventListener('pointerdown', first('pointer'), true);
  addEventListener('keydown', first('key'), true);
  for (const type of ['pointerup', 'mousedown', 'mouseup', 'touchstart', 'touchend', 'click']) {
    addEventListener(type, rest('pointer', 'click'), { capture: true, passive: false });
  }
  for (const type of ['keypress', 'keyup']) addEventListener(type, rest('key', 'keyup'), true);
  // Enter and space act as a click of their own, between keydown and keyup.
  addEventListener('click', rest('key', ''), true);
}
