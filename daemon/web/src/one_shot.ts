// A script of its own that runs first: the one-shot word leaves the address before anything else runs, so it stays
// neither in the history nor in a shared link.

/** The word of `#t=WORD` in the address, or null; removes it from the address. */
export function takeOneShot(): string | null {
  const word = /^#t=([^&]*)/.exec(location.hash)?.[1];
  if (word === undefined) return null;
  history.replaceState(null, '', location.pathname + location.search + '#/');
  return decodeURIComponent(word);
}

export const oneShotAtStart = takeOneShot();
