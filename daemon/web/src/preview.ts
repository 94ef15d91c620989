// SPDX-License-Identifier: MIT
// Previews while a hand moves: drafts at once, the exact design once it rests. One request is in
// work and at most one waits; a newer input replaces the one that waits, and ends an exact one.

export type Quality = 'draft' | 'exact';

export interface Asked<I> {
  input: I;
  quality: Quality;
  turn: number;
}

export interface PreviewEvents<I, R> {
  run: (input: I, quality: Quality, signal: AbortSignal) => Promise<R>;
  onResult: (result: R, asked: Asked<I>) => void;
  onFailure: (error: unknown, asked: Asked<I>) => void;
  /** Whether anything is in work or waits. */
  onBusy?: (busy: boolean) => void;
  rest_ms?: number;
}

/** Shows the newest answer only: an answer to an older input than the one shown is dropped. */
export class Previews<I, R> {
  private readonly events: PreviewEvents<I, R>;
  private turn = 0;
  private shown = 0;
  private shownExact = 0;
  private current: { asked: Asked<I>; abort: AbortController } | null = null;
  private waiting: Asked<I> | null = null;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private ended = false;

  constructor(events: PreviewEvents<I, R>) {
    this.events = events;
  }

  /** A new input. `settled`: nothing moves, so ask for the exact design without waiting. */
  input(input: I, settled = false): void {
    this.turn++;
    const turn = this.turn;
    if (this.timer) clearTimeout(this.timer);
    this.timer = null;
    if (settled) {
      this.ask({ input, quality: 'exact', turn });
      return;
    }
    this.ask({ input, quality: 'draft', turn });
    this.timer = setTimeout(() => {
      this.timer = null;
      if (turn === this.turn) this.ask({ input, quality: 'exact', turn });
    }, this.events.rest_ms ?? 150);
    this.tell();
  }

  get busy(): boolean {
    return this.current !== null || this.waiting !== null || this.timer !== null;
  }

  /** What is asked for is not wanted any more, whatever comes of it. */
  drop(): void {
    this.shown = this.shownExact = ++this.turn;
    if (this.timer) clearTimeout(this.timer);
    this.timer = null;
    this.waiting = null;
    this.current?.abort.abort();
    this.tell();
  }

  end(): void {
    this.ended = true;
    if (this.timer) clearTimeout(this.timer);
    this.current?.abort.abort();
    this.waiting = null;
  }

  private tell(): void {
    if (!this.ended) this.events.onBusy?.(this.busy);
  }

  private ask(asked: Asked<I>): void {
    if (this.ended) return;
    this.waiting = asked;
    if (this.current && this.current.asked.quality === 'exact') this.current.abort.abort();
    void this.next();
  }

  private async next(): Promise<void> {
    if (this.current || !this.waiting || this.ended) {
      this.tell();
      return;
    }
    const asked = this.waiting;
    this.waiting = null;
    const abort = new AbortController();
    this.current = { asked, abort };
    this.tell();
    try {
      const result = await this.events.run(asked.input, asked.quality, abort.signal);
      this.current = null;
      if (!abort.signal.aborted && this.isNewer(asked)) {
        this.shown = asked.turn;
        if (asked.quality === 'exact') this.shownExact = asked.turn;
        this.events.onResult(result, asked);
      }
    } catch (error) {
      this.current = null;
      if (!abort.signal.aborted && !this.ended && asked.turn >= this.shown) this.events.onFailure(error, asked);
    }
    void this.next();
  }

  private isNewer(asked: Asked<I>): boolean {
    if (this.ended || asked.turn < this.shown) return false;
    return asked.quality === 'exact' || asked.turn > this.shownExact;
  }
}
