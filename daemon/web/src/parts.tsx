// The parts that every view is made of.
import { useSignal } from '@preact/signals';
import type { ComponentChildren, RefObject } from 'preact';
import { useEffect, useId, useLayoutEffect, useRef, useState } from 'preact/hooks';
import { isProblem, readBlob, type ServerProblem } from './server';
import { words } from './words';

type Kind = 'primary' | 'quiet' | 'danger' | 'plain';

interface ButtonProps {
  children: ComponentChildren;
  onClick: (event: MouseEvent) => void;
  kind?: Kind;
  big?: boolean;
  disabled?: boolean;
  label?: string;
  title?: string;
  class?: string;
}

export function Button({ children, onClick, kind = 'plain', big, disabled, label, title, class: extra }: ButtonProps) {
  return (
    <button type="button" class={`button button-${kind}${big ? ' button-big' : ''}${extra ? ` ${extra}` : ''}`}
      onClick={onClick} disabled={disabled} aria-label={label} title={title}>{children}</button>
  );
}

/** A link that looks like a button: it leads somewhere and does nothing else. */
export function LinkButton({ href, children, kind = 'plain', big }: {
  href: string; children: ComponentChildren; kind?: Kind; big?: boolean;
}) {
  return <a class={`button button-${kind}${big ? ' button-big' : ''}`} href={href}>{children}</a>;
}

/** Runs `act` on a press; while it is under way the button is off. A problem is handed to `onProblem`. */
export function useAct(onProblem: (problem: ServerProblem | null) => void) {
  const [busy, setBusy] = useState(false);
  const alive = useRef(true);
  useEffect(() => () => { alive.current = false; }, []);
  const run = async (what: () => Promise<unknown>): Promise<boolean> => {
    setBusy(true);
    onProblem(null);
    try {
      await what();
      return true;
    } catch (error) {
      if (!isProblem(error)) throw error;
      if (alive.current) onProblem(error);
      return false;
    } finally {
      if (alive.current) setBusy(false);
    }
  };
  return { busy, run };
}

/** A refusal in our words, with the server's sentence as text below. */
export function Trouble({ problem, onClose, children }: {
  problem: ServerProblem; onClose?: () => void; children?: ComponentChildren;
}) {
  const said = words.problems[problem.kind] ?? words.problems.other;
  const listed = problem.errors.length > 1 || problem.detail === '' ? problem.errors : [];   // a single one is the sentence
  return (
    <div class="note note-bad" role="alert">
      <p><strong>{said}</strong></p>
      {problem.detail && <p class="server-words">{problem.detail}</p>}
      {listed.length > 0 && (
        <ul class="server-words">
          {listed.slice(0, 5).map((one) => <li key={one.pointer + one.code}>{one.pointer} {one.detail}</li>)}
        </ul>
      )}
      {children}
      {problem.status >= 500 && problem.requestId && <p class="small">{words.request(problem.requestId)}</p>}
      {onClose && <Button kind="quiet" onClick={onClose}>{words.close}</Button>}
    </div>
  );
}

/**
 * A question over the page. It opens as it is drawn; Esc and `no` close it, and neither acts. Focus is on `no`.
 */
export function Dialog({ title, children, no, yes, onNo, onYes, kind = 'primary', busy, wide }: {
  title: string; children?: ComponentChildren; no?: string; yes?: string; onNo: () => void; onYes?: () => void;
  kind?: Kind; busy?: boolean; wide?: boolean;
}) {
  const dialog = useRef<HTMLDialogElement>(null);
  const refuse = useRef<HTMLButtonElement>(null);
  const id = useId();
  useLayoutEffect(() => {
    const before = document.activeElement as HTMLElement | null;
    dialog.current?.showModal();
    refuse.current?.focus({ preventScroll: true });   // what is asked stands above
    return () => before?.isConnected && before.focus();
  }, []);
  return (
    <dialog ref={dialog} class={wide ? 'dialog dialog-wide' : 'dialog'} aria-labelledby={id}
      onCancel={(event) => { event.preventDefault(); onNo(); }}>
      <h2 id={id}>{title}</h2>
      {children}
      <div class="dialog-buttons">
        <button ref={refuse} type="button" class="button button-plain button-big" onClick={onNo}>
          {no ?? words.cancelled}
        </button>
        {yes && <Button kind={kind} big onClick={() => onYes?.()} disabled={busy}>{yes}</Button>}
      </div>
    </dialog>
  );
}

/** One tick that a person makes: a large target with its own tap. */
export function Tick({ checked, onChange, children, disabled, big }: {
  checked: boolean; onChange: (checked: boolean) => void; children: ComponentChildren; disabled?: boolean; big?: boolean;
}) {
  return (
    <label class={`tick${big ? ' tick-big' : ''}${checked ? ' tick-on' : ''}`}>
      <input type="checkbox" checked={checked} disabled={disabled}
        onChange={(event) => onChange(event.currentTarget.checked)} />
      <span>{children}</span>
    </label>
  );
}

export function Choice<T extends string>({ label, value, options, onChange }: {
  label: string; value: T; options: [T, string][]; onChange: (value: T) => void;
}) {
  return (
    <label class="field">
      <span>{label}</span>
      <select value={value} onChange={(event) => onChange(event.currentTarget.value as T)}>
        {options.map(([name, text]) => <option key={name} value={name} selected={name === value}>{text}</option>)}
      </select>
    </label>
  );
}

/** How far something is, from 0 to 1, with the words that say so. */
export function Meter({ share, label }: { share: number; label: string }) {
  const bar = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => { bar.current!.style.inlineSize = `${Math.min(1, Math.max(0, share)) * 100}%`; }, [share]);
  return (
    <div class="meter" role="progressbar" aria-valuemin={0} aria-valuemax={100}
      aria-valuenow={Math.floor(share * 100)} aria-label={label}><div ref={bar} /></div>
  );
}

const kPictures = 60;
const pictures = new Map<string, Promise<string>>();

/** The address of a picture of popcutd, read with our token and kept while this page is open. */
function pictureAddress(path: string): Promise<string> {
  const known = pictures.get(path);
  if (known) return known;
  const made = readBlob(path, { accept: 'image/*' }).then((blob) => URL.createObjectURL(blob));
  pictures.set(path, made);
  made.catch(() => pictures.delete(path));
  if (pictures.size > kPictures) {
    const [oldest, address] = pictures.entries().next().value!;
    pictures.delete(oldest);
    void address.then((one) => setTimeout(() => URL.revokeObjectURL(one), 1000), () => undefined);
  }
  return made;
}

/** A picture that popcutd draws, as an image: nothing in it can act. Read as it comes into sight. */
export function Picture({ path, alt, class: extra = '' }: { path: string | null; alt: string; class?: string }) {
  const [address, setAddress] = useState<string | null>(null);
  const box = useRef<HTMLSpanElement>(null);
  useEffect(() => {
    setAddress(null);
    if (!path) return;
    let wanted = true;
    const seen = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      seen.disconnect();
      pictureAddress(path).then((one) => { if (wanted) setAddress(one); }, () => undefined);
    });
    seen.observe(box.current!);
    return () => { wanted = false; seen.disconnect(); };
  }, [path]);
  return (
    <span ref={box} class={`picture ${extra}`}>
      {address ? <img src={address} alt={alt} /> : <span class="picture-none" {...(alt ? { role: 'img', 'aria-label': alt } : {})} />}
    </span>
  );
}

/** What stands there until the content comes: text only after 2 s. */
export function Loading() {
  const slow = useSignal(false);
  useEffect(() => {
    const timer = setTimeout(() => { slow.value = true; }, 2000);
    return () => clearTimeout(timer);
  }, []);
  return <div class="loading" role="status">{slow.value ? words.loading : ''}</div>;
}

/** A note with a heading, for what is not wrong. */
export function Note({ kind = 'plain', children }: { kind?: 'plain' | 'amber' | 'good'; children: ComponentChildren }) {
  return <div class={`note note-${kind}`}>{children}</div>;
}

export type Ref<T> = RefObject<T>;

/** Asks popcutd one thing at a time: whether it is at work, and what it refused. Other faults go on. */
export function useAsking() {
  const busy = useSignal(false);
  const problem = useSignal<ServerProblem | null>(null);
  const run = async (ask: () => Promise<void>): Promise<void> => {
    if (busy.peek()) return;
    busy.value = true;
    problem.value = null;
    try {
      await ask();
    } catch (error) {
      if (!isProblem(error)) throw error;
      problem.value = error;
    } finally {
      busy.value = false;
    }
  };
  return { busy, problem, run };
}
