// SPDX-License-Identifier: MIT
// What a tab keeps until it is closed: in sessionStorage; where the browser forbids that or has no room, in this page alone.
const here = new Map<string, string>();

/** Null where the browser forbids it. */
export const tabSession: Storage | null = (() => {
  try {
    return sessionStorage;
  } catch {
    return null;
  }
})();

export const tabStore = {
  getItem: (key: string): string | null => here.get(key) ?? tabSession?.getItem(key) ?? null,

  setItem(key: string, value: string): void {
    here.set(key, value);
    if (!tabSession) return;
    try {
      tabSession.setItem(key, value);
      here.delete(key);
    } catch {
      // full: this page holds it
    }
  },

  removeItem(key: string): void {
    here.delete(key);
    tabSession?.removeItem(key);
  },
};
