// The stream of events of popcutd: read by fetch, so that the token stays out of the address.
import { readAnswer, isProblem, session } from './server';

export interface StreamEvent { kind: string; data: Record<string, unknown> }

/** What the stream calls. `quiet` ms without a byte make what is shown stale. */
export interface Listener {
  event(event: StreamEvent): void;
  byte(): void;                       // something came, a heartbeat for example
  opened(): void;
  closed(): void;
  quiet_ms(): number;
}

const kWait_ms = [500, 1000, 2000, 5000];
const kHidden_ms = 20_000;

/**
 * Takes the text of an event stream apart. `push` gets it in any pieces and returns the events that are complete.
 * Comments are skipped. After the WHATWG standard, with the fields event, data and id.
 */
export class StreamText {
  lastId = '';
  private rest = '';
  private kind = '';
  private data: string[] = [];
  private endedWithReturn = false;

  push(text: string): StreamEvent[] {
    const events: StreamEvent[] = [];
    if (this.endedWithReturn && text.startsWith('\n')) text = text.slice(1);
    this.endedWithReturn = text.endsWith('\r');
    const lines = (this.rest + text).split(/\r\n|\r|\n/);
    this.rest = lines.pop() ?? '';
    for (const line of lines) {
      if (line === '') {
        const event = this.finish();
        if (event) events.push(event);
      } else {
        this.field(line);
      }
    }
    return events;
  }

  private field(line: string): void {
    const colon = line.indexOf(':');
    if (colon === 0) return;
    const name = colon < 0 ? line : line.slice(0, colon);
    const value = colon < 0 ? '' : line.slice(colon + 1).replace(/^ /, '');
    if (name === 'event') this.kind = value;
    else if (name === 'data') this.data.push(value);
    else if (name === 'id' && !value.includes('\0')) this.lastId = value;
  }

  private finish(): StreamEvent | null {
    const text = this.data.join('\n');
    const kind = this.kind || 'message';
    this.data = [];
    this.kind = '';
    if (text === '') return kind === 'message' ? null : { kind, data: {} };
    try {
      const data: unknown = JSON.parse(text);
      return { kind, data: typeof data === 'object' && data !== null ? data as Record<string, unknown> : {} };
    } catch {
      return { kind, data: {} };
    }
  }
}

/** Follows the events until `stop()`; comes back after 0.5, 1, 2, 5, 5 s... and at once if the network or page wakes. */
export class EventStream {
  private stopped = false;
  private attempt = 0;
  private lastId = '';
  private current: AbortController | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private watch: ReturnType<typeof setInterval> | undefined;
  private lastByte = 0;
  private asleep = false;
  private hiddenTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly listener: Listener) {
    document.addEventListener('visibilitychange', this.woken);
    addEventListener('online', this.again);
    this.watch = setInterval(() => this.look(), 500);
    void this.run();
  }

  stop(): void {
    this.stopped = true;
    this.current?.abort();
    clearTimeout(this.timer);
    clearTimeout(this.hiddenTimer);
    clearInterval(this.watch);
    document.removeEventListener('visibilitychange', this.woken);
    removeEventListener('online', this.again);
  }

  /** Drops what may hang and connects at once. */
  readonly again = (): void => {
    if (this.stopped) return;
    this.attempt = 0;
    clearTimeout(this.timer);
    if (this.current) this.current.abort();
    else void this.run();
  };

  /**
   * A page that nobody sees lets go of its connection: a browser opens only six to one server, so streams of tabs in
   * the background would keep a Pause from leaving.
   */
  private readonly woken = (): void => {
    clearTimeout(this.hiddenTimer);
    if (document.visibilityState !== 'visible') {
      this.hiddenTimer = setTimeout(() => {
        this.asleep = true;
        clearTimeout(this.timer);
        this.current?.abort();
      }, kHidden_ms);
      return;
    }
    this.asleep = false;
    if (!this.current || Date.now() - this.lastByte > this.listener.quiet_ms()) this.again();
  };

  /** A stream that is silent for twice as long as a live one ever is hangs: connect again. */
  private look(): void {
    if (this.current && Date.now() - this.lastByte > 2 * this.listener.quiet_ms()) this.current.abort();
  }

  private async run(): Promise<void> {
    const mine = new AbortController();
    this.current = mine;
    this.lastByte = Date.now();
    try {
      await this.follow(mine.signal);
    } catch (error) {
      if (isProblem(error) && error.status === 401) this.stopped = true;
    }
    this.current = null;
    this.listener.closed();
    if (this.stopped || this.asleep || session.value !== 'in') return;
    const wait_ms = mine.signal.aborted && this.attempt === 0 ? 0 : kWait_ms[Math.min(this.attempt, 3)];
    ++this.attempt;
    this.timer = setTimeout(() => void this.run(), wait_ms);
  }

  private async follow(signal: AbortSignal): Promise<void> {
    const headers: Record<string, string> = this.lastId ? { 'Last-Event-ID': this.lastId } : {};
    const answer = await readAnswer('/v1/events', { accept: 'text/event-stream', headers, signal });
    const reader = answer.body!.pipeThrough(new TextDecoderStream()).getReader();
    const text = new StreamText();
    text.lastId = this.lastId;
    this.listener.opened();
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      this.attempt = 0;
      this.lastByte = Date.now();
      this.listener.byte();
      for (const event of text.push(value)) this.listener.event(event);
      this.lastId = text.lastId;
    }
  }
}
