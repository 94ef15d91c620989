// A hand that drags a slider of a design, and what is said of times. Both pages are measured with this.
import { wait } from './harness.mjs';

const sorted = (values) => values.slice().sort((a, b) => a - b);
const at = (values, share) => sorted(values)[Math.min(values.length - 1, Math.floor(values.length * share))];
export const median = (values) => at(values, 0.5);
export const p95 = (values) => at(values, 0.95);

/** A line of a figure, with its budget if it has one, which `more` says to be a least. */
export function say(what, value, unit, budget, more = false) {
  const figure = `${what.padEnd(52)} ${value.toFixed(value < 10 ? 2 : 0).padStart(8)} ${unit.padEnd(4)}`;
  const over = more ? value < budget : value > budget;
  console.log(budget === null ? figure : `${figure} budget ${String(budget).padStart(4)}${over ? '  OVER' : ''}`);
}

/** A card that is turned about its spine. */
export const revolution = (units, slices, width) => ({
  popcut: 1, name: 'bench', surface: { type: 'revolution', radius: { points: [[-10, 60], [25, 75], [50, 80], [75, 75], [110, 60]] } },
  units_per_slice: units, slices, widths_mm: width, min_panel_mm: 0.1,
});

/**
 * Times from an input event to the picture of its draft, and from the last input to the exact one, ms; closes the page.
 * `rests`: how often the hand moves once more afterwards, and rests until the exact one is there. `look_ms`: how long a
 * person looks at the page before.
 */
export async function dragging({ page, close }, spec, rests = 0, look_ms = 0) {
  await page.evaluate((text) => sessionStorage.setItem('popcut.design.steps', JSON.stringify({ steps: [text], at: 0 })), JSON.stringify(spec));
  await page.evaluate(() => { location.hash = '#/design'; });
  const goOn = page.getByRole('button', { name: 'Go on with your last design' });
  await goOn.waitFor();
  await wait(look_ms);
  await goOn.click();
  await page.locator('.badge', { hasText: 'exact' }).waitFor({ timeout: 60_000 });
  await wait(3000);
  const result = await page.evaluate(async (more) => {
    const input = document.querySelector('.slider input[type=range]:not([disabled])[step="0.1"]');
    const set = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set;
    const drawn = { 'popcut.draft': [], 'popcut.exact': [] };
    const tasks = [];
    const gl = document.querySelector('.stage-canvas').getContext('webgl2');
    // The time counts until the GPU has drawn it. Reading pixels would wait in the page's own thread.
    const finished = async (sync) => {
      while (gl.getSyncParameter(sync, gl.SYNC_STATUS) !== gl.SIGNALED) await new Promise((done) => setTimeout(done, 0));
      gl.deleteSync(sync);
    };
    new PerformanceObserver((list) => {
      for (const mark of list.getEntries()) {
        const sync = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        finished(sync).then(() => drawn[mark.name]?.push({ input: mark.detail, time: performance.now() }));
      }
    }).observe({ entryTypes: ['mark'] });
    new PerformanceObserver((list) => { for (const one of list.getEntries()) tasks.push(one.duration); }).observe({ entryTypes: ['longtask'] });
    let last = 0;
    for (let i = 0; i < 60; i++) {
      set.call(input, String(0.5 + (i % 10) / 10));
      last = performance.now();
      input.dispatchEvent(new Event('input', { bubbles: true }));
      await new Promise((done) => setTimeout(done, 33));
    }
    input.dispatchEvent(new Event('change', { bubbles: true }));
    const exact = async () => {
      const end = performance.now() + 20_000;
      const found = () => drawn['popcut.exact'].find(({ time, input: from }) => time > last && from >= last - 5);
      while (!found() && performance.now() < end) await new Promise((done) => setTimeout(done, 10));
      return (found()?.time ?? Infinity) - last;
    };
    const rested = await exact();
    const result = { times: drawn['popcut.draft'].map(({ input: from, time }) => time - from), exact: rested, tasks };
    for (let i = 0; i < more; i++) {
      set.call(input, String(0.6 + i / 10));
      last = performance.now();
      input.dispatchEvent(new Event('input', { bubbles: true }));
      input.dispatchEvent(new Event('change', { bubbles: true }));
      await exact();
    }
    return result;
  }, rests);
  await close();
  return result;
}
