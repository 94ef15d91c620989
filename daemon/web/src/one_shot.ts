// A script of its own that runs first: the one-shot word leaves the address before anything else runs, so it stays
// neither in the history nor in a shared link.

/** The word of `#t=WORD` in the address, or null; removes it from the address. A broken escape stays as it is. */
export function takeOneShot(): string | null {
  const word = /^#t=([^&]*)/.exec(location.hash)?.[1];
  if (word === undefined) return null;
  history.replaceState(null, '', location.pathname + location.search + '#/');
  try {
    return decodeURIComponent(word);
  } catch {
    return word;
  }
}

export const oneShotAtStart = takeOneShot();
