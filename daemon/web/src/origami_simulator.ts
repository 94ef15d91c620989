// SPDX-License-Identifier: MIT
// Hands a pattern to Origami Simulator in a window of its own. It takes {op: 'importFold', fold} once it said
// {from: 'OrigamiSimulator', status: 'ready'} (its js/importer.js).

const kAddress = 'https://origamisimulator.org';
const kPatience_ms = 120_000;

/**
 * Opens the window at once, since a browser allows that only while a press is handled; sends what `fold` gives once both
 * are there, and to that site only. Gives false if the browser opens no window. Throws what `fold` throws.
 */
export async function openInSimulator(fold: () => Promise<unknown>): Promise<boolean> {
  const other = window.open(`${kAddress}/`, '_blank');
  if (!other) return false;
  let stop = (): void => undefined;
  const ready = new Promise<boolean>((done) => {
    const hear = (event: MessageEvent): void => {
      const data = event.data as { from?: unknown; status?: unknown } | null;
      if (event.origin !== kAddress || event.source !== other) return;
      if (data?.from === 'OrigamiSimulator' && data.status === 'ready') done(true);
    };
    addEventListener('message', hear);
    const timer = setTimeout(() => done(false), kPatience_ms);
    stop = () => {
      removeEventListener('message', hear);
      clearTimeout(timer);
    };
  });
  try {
    const pattern = await fold();
    if (await ready) other.postMessage({ op: 'importFold', fold: pattern }, kAddress);
  } catch (error) {
    other.close();
    throw error;
  } finally {
    stop();
  }
  return true;
}
