// The way in for a screen without a session: a code that somebody who is signed in allows.
import { useEffect, useState } from 'preact/hooks';
import { Button, Trouble } from './parts';
import { isProblem, openAsk, signInWith, type ServerProblem } from './server';
import { now } from './store';
import { clockTime, words } from './words';

const kAsk_ms = 2000;

interface Pairing { code: string; secret: string; expires: string; lapsed: boolean }

function screenKind(): string {
  if (!matchMedia('(pointer: coarse)').matches) return words.signIn.computer;
  return Math.min(screen.width, screen.height) < 600 ? words.signIn.phone : words.signIn.tablet;
}

export function SignIn({ again = false, badWord = false }: { again?: boolean; badWord?: boolean }) {
  const [name, setName] = useState(screenKind);
  const [pairing, setPairing] = useState<Pairing | null>(null);
  const [problem, setProblem] = useState<ServerProblem | null>(null);

  const ask = async (): Promise<void> => {
    setProblem(null);
    try {
      const answer = await openAsk<Omit<Pairing, 'lapsed'>>('/v1/session/pair', { name: name.trim() || screenKind() });
      setPairing({ ...answer, lapsed: false });
    } catch (error) {
      if (!isProblem(error)) throw error;
      setProblem(error);
    }
  };

  const secret = pairing && !pairing.lapsed ? pairing.secret : null;
  useEffect(() => {
    if (secret === null) return;
    const stop = new AbortController();
    const collect = async (): Promise<void> => {
      try {
        const answer = await openAsk<{ token?: string }>('/v1/session/pair/collect', { secret }, stop.signal);
        if (answer.token) {
          signInWith(answer.token);
          return;
        }
      } catch (error) {
        if (stop.signal.aborted) return;
        if (isProblem(error) && error.status === 404) {
          setPairing((known) => known && { ...known, lapsed: true });
          return;
        }
      }
      if (!stop.signal.aborted) timer = setTimeout(() => void collect(), kAsk_ms);
    };
    let timer = setTimeout(() => void collect(), kAsk_ms / 2);
    return () => { stop.abort(); clearTimeout(timer); };
  }, [secret]);

  const left_s = pairing ? (Date.parse(pairing.expires) - now.value) / 1000 : 0;
  const form = pairing === null || pairing.lapsed ? (
    <form class="stack" onSubmit={(event) => { event.preventDefault(); void ask(); }}>
      {pairing?.lapsed && <p role="status">{words.signIn.lapsed}</p>}
      <label class="field">
        <span>{words.signIn.name}</span>
        <input value={name} maxLength={60} autocomplete="off" onInput={(event) => setName(event.currentTarget.value)} />
      </label>
      <button type="submit" class="button button-primary button-big">
        {pairing?.lapsed ? words.signIn.again : words.signIn.get}
      </button>
    </form>
  ) : (
    <div class="stack">
      <p>{words.signIn.code}</p>
      <p class="pair-code" aria-label={[...pairing.code].join(' ')}>{pairing.code}</p>
      <p>{words.signIn.codeWhat}</p>
      <p class="muted" role="timer">{words.signIn.waits(clockTime(Math.min(300, left_s)))}</p>
      <Button kind="quiet" onClick={() => setPairing(null)}>{words.back}</Button>
    </div>
  );
  const body = <>{problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}{form}</>;
  if (again) return <div class="sign-again">{body}</div>;
  return (
    <main class="sign-in">
      <p class="bar-name">{words.title}</p>
      <h1>{words.signIn.title}</h1>
      {badWord && <p class="note note-amber" role="alert">{words.signIn.bad}</p>}
      <p>{words.now.what}</p>
      <p>{words.signIn.what}</p>
      {body}
    </main>
  );
}
