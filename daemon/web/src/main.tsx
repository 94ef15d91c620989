import { oneShotAtStart, takeOneShot } from './one_shot';
import { effect, signal, useSignal } from '@preact/signals';
import { render, type ComponentType } from 'preact';
import { useEffect, useRef, useState } from 'preact/hooks';
import { useAgain } from './again';
import { Done } from './done';
import { takeDrops } from './handed';
import { Machine } from './machine';
import { Now } from './now';
import { Button, Dialog, Loading, Note } from './parts';
import { pauseAll, PauseBar } from './pause';
import { go, parseRoute, route } from './route';
import { isProblem, ServerProblem, session, signInWithWord, waitsUntil } from './server';
import { SignIn } from './sign_in';
import { can, connection, follow, loaded, me, meta, now, readMeta, jobs, stale, tryNow } from './store';
import { begin as beginBackend, newer, reload, storeTrouble } from './backend';
import { unsaved } from './unsaved';
import { swallowWaking } from './waking';
import { hourMinuteSecond, words } from './words';

/** How long nothing may have been at stake before the page of another popcutd is loaded, ms. */
const kReload_ms = 1000;

const later = ['design', 'sheets', 'glue', 'fold', 'settings'];

let laterStyle: Promise<unknown> | null = null;

/** Adds the style of the views that are loaded later, once; they are shown when it is there. */
function withLaterStyle(): Promise<unknown> {
  laterStyle ??= new Promise((done, failed) => {
    const address = document.querySelector<HTMLMetaElement>('meta[name=later-style]')?.content;
    if (!address) return done(null);
    const link = document.createElement('link');
    link.rel = 'stylesheet';
    link.href = address;
    link.onload = done;
    link.onerror = () => { laterStyle = null; failed(new Error(address)); };
    document.head.append(link);
  });
  return laterStyle;
}

/** A view that is loaded when it is first shown; it fails softly while popcutd is away, and after an update until that is known. */
function Later({ view, rest }: { view: string; rest: string }) {
  const View = useSignal<ComponentType<{ rest: string }> | null>(null);
  const failed = useSignal<ServerProblem | null>(null);
  useEffect(() => {
    View.value = null;
    Promise.all([import('./later'), withLaterStyle()]).then(([{ views }]) => {
      View.value = views[view as keyof typeof views];
      failed.value = null;
    }, () => { failed.value = new ServerProblem(0, { type: 'unreachable' }); });
  }, [view, useAgain(failed.value)]);
  if (failed.value) {
    return (
      <Note kind="amber">
        <p>{words.problems.unreachable}</p>
        <Button onClick={() => location.reload()}>{words.live.reload}</Button>
      </Note>
    );
  }
  return View.value ? <View.value rest={rest} /> : <Loading />;
}

/** Where nothing is queued, one begins with a design. */
const viewOf = (view: string): string => (view === 'now' && !can('queue') ? 'design' : view);

function View() {
  const { rest } = route.value;
  const view = viewOf(route.value.view);
  if (view === 'now') return <Now />;
  if (view === 'at' && can('devices')) return <Machine device={rest} key={rest} />;
  if (view === 'done' && can('queue')) return <Done />;
  if (later.includes(view)) return <Later view={view} rest={rest} key={view} />;
  return <Note><p>{words.notFound}</p><p><a href="#/">{words.toNow}</a></p></Note>;
}

function Connection() {
  const { open, at } = connection.value;
  if (!loaded.value) return <span class="live live-off">{words.live.connecting}</span>;
  const old = stale.value || !open;
  return (
    <span class={`live ${old ? 'live-off' : 'live-on'}`} role="status">
      {old ? words.live.stale(hourMinuteSecond(at)) : words.live.live}
    </span>
  );
}

function Bar() {
  const view = viewOf(route.value.view);
  const names = (['now', 'design', 'done', 'settings'] as const).filter((name) => can('queue') || (name !== 'now' && name !== 'done'));
  const person = can('users') ? me.value : null;
  return (
    <header class="bar">
      <a class="bar-name" href="#/">{words.title}</a>
      <nav aria-label={words.views.main}>
        {names.map((name) => (
          <a key={name} href={name === 'now' ? '#/' : `#/${name}`}
            aria-current={view === name || (name === 'now' && view === 'at') ? 'page' : undefined}>{words.views[name]}</a>
        ))}
      </nav>
      <div class="bar-end">
        {can('queue') && <Connection />}
        {person && <span class="bar-person">
          {words.person(person.title ?? person.name, words.roles[person.role] ?? person.role)}
        </span>}
      </div>
    </header>
  );
}

/** Nobody answers a question or types: loading the page again would take that away. */
const isIdle = (): boolean => document.querySelector('dialog[open]') === null && !typing(document.activeElement);

/** popcutd is another one than this page came from: load its page, soon if nothing can be lost. */
function Updated({ first }: { first: string }) {
  const other = meta.value !== null && first !== '' && pageOf() !== first;
  const quiet = ![...jobs.value.values()].some((job) => ['armed', 'cutting', 'paused'].includes(job.state));
  const waits = newer.value;
  const ready = other && quiet && !unsaved.value && now.value > 0 && isIdle();   // looked at again as time goes on
  useEffect(() => {
    if (!ready) return undefined;
    const timer = setTimeout(() => { if (isIdle()) location.reload(); }, kReload_ms);
    return () => clearTimeout(timer);
  }, [ready]);
  if (!other && !waits) return null;
  return (
    <div class="note note-amber band">
      <p>{waits ? words.live.newer : words.live.updated}</p>
      <Button onClick={() => void reload()}>{words.live.reload}</Button>
    </div>
  );
}

const pageOf = (): string => (meta.value ? meta.value.page ?? meta.value.build : '');

function Old() {
  if (session.value === 'over') {
    return (
      <div class="band">
        <h2>{words.signIn.over}</h2>
        <p>{words.signIn.overWhat}</p>
        <SignIn again />
      </div>
    );
  }
  if (!stale.value) return null;
  return (
    <div class="note note-amber band" role="status">
      <p>{words.live.staleLong(hourMinuteSecond(connection.value.at))}</p>
      <Button onClick={tryNow}>{words.live.again}</Button>
    </div>
  );
}

/** What is made now would be lost with this tab. */
function Unkept() {
  const why = storeTrouble.value;
  return why === null ? null : <div class="note note-amber band" role="status"><p>{words.live.unkept[why]}</p></div>;
}

function Waiting() {
  const left_s = Math.ceil((waitsUntil.value - now.value) / 1000);
  return left_s > 1 ? <p class="band small" role="status">{words.live.waiting(String(left_s))}</p> : null;
}

function Keys({ onClose }: { onClose: () => void }) {
  const rows = [['?', words.settings.keyHelp], ['p', words.settings.keyPause], ['1', words.settings.keyNow],
    ['2', words.settings.keyDesign], ['3', words.settings.keyDone], ['4', words.settings.keySettings]]
    .filter(([key]) => can('queue') || !['p', '1', '3'].includes(key!)) as [string, string][];
  return (
    <Dialog title={words.settings.keys} no={words.close} onNo={onClose}>
      <dl class="keys">{rows.map(([key, what]) => <div key={key}><dt><kbd>{key}</kbd></dt><dd>{what}</dd></div>)}</dl>
    </Dialog>
  );
}

function typing(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && (target.isContentEditable
    || ['INPUT', 'SELECT', 'TEXTAREA'].includes(target.tagName)) && !(target instanceof HTMLInputElement
    && ['checkbox', 'radio', 'range', 'button'].includes(target.type));
}

function Page() {
  const [keys, setKeys] = useState(false);
  const firstPage = useRef('');
  if (firstPage.current === '') firstPage.current = pageOf();
  const main = useRef<HTMLElement>(null);
  const old = stale.value;

  useEffect(() => {
    const pressed = (event: KeyboardEvent): void => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.repeat || typing(event.target)) return;
      const views: Record<string, string> = { 1: '#/', 2: '#/design', 3: '#/done', 4: '#/settings' };
      if (event.key === '?') setKeys(true);
      else if (event.key === 'p') pauseAll();
      else if (['1', '3'].includes(event.key) && !can('queue')) return;
      else if (views[event.key] && !document.querySelector('dialog[open]')) go(views[event.key]!);
    };
    addEventListener('keydown', pressed);
    return () => removeEventListener('keydown', pressed);
  }, []);

  const view = viewOf(route.value.view);
  const shown = useRef(view);
  useEffect(() => {
    if (shown.current === view) return;
    shown.current = view;
    scrollTo(0, 0);
    main.current?.focus({ preventScroll: true });
  }, [view]);

  return (
    <>
      <a class="skip" href="#main" onClick={(event) => { event.preventDefault(); main.current?.focus(); }}>
        {words.views.skip}
      </a>
      <Bar />
      <Updated first={firstPage.current} />
      <Old />
      <Waiting />
      <Unkept />
      <main ref={main} id="main" tabIndex={-1} class={`view view-${view}${old ? ' view-old' : ''}`}>
        <View />
      </main>
      <PauseBar />
      <OtherSession />
      {keys && <Keys onClose={() => setKeys(false)} />}
    </>
  );
}

/** A word of the address that would end the session of this tab. Anybody can send such a link, so a person is asked. */
const askedWord = signal<string | null>(null);

function OtherSession() {
  const word = askedWord.value;
  if (word === null) return null;
  const change = (): void => {
    askedWord.value = null;
    void signInWithWord(word).then(() => location.reload(), () => undefined);
  };
  return (
    <Dialog title={words.signIn.other} no={words.signIn.stay} yes={words.signIn.change} kind="plain"
      onNo={() => { askedWord.value = null; }} onYes={change}>
      <p>{words.signIn.otherWhat}</p>
    </Dialog>
  );
}

/** The page, or the way in. What was shown stays when the session ends. */
function Root({ badWord }: { badWord: boolean }) {
  if (session.value === 'none') return <SignIn badWord={badWord} />;
  return meta.value === null && session.value !== 'over' ? <Start /> : meta.value === null ? <SignIn /> : <Page />;
}

/** Asks who we are, until popcutd answers. */
function Start() {
  const silent = useSignal(false);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout>;
    let wait_ms = 500;
    const ask = (): void => {
      readMeta().then(follow, (error) => {
        if (isProblem(error) && error.status === 401) return;
        silent.value = true;
        timer = setTimeout(ask, wait_ms);
        wait_ms = Math.min(5000, wait_ms * 2);
      });
    };
    ask();
    return () => clearTimeout(timer);
  }, []);
  return silent.value ? <main class="view"><Note kind="amber"><p>{words.problems.unreachable}</p></Note></main> : <Loading />;
}

/** Signs in with the word of the address, if there is one; then shows the page. */
async function begin(word: string | null): Promise<void> {
  let badWord = false;
  if (word !== null && session.value === 'in') {
    askedWord.value = word;
  } else if (word !== null) {
    try {
      await signInWithWord(word);
    } catch (error) {
      if (!isProblem(error)) throw error;
      badWord = session.value === 'none';
    }
  }
  render(<Root badWord={badWord} />, document.getElementById('page')!);
}

beginBackend();
swallowWaking();
takeDrops();
document.documentElement.lang = 'en';
addEventListener('hashchange', () => {
  const word = takeOneShot();
  if (word === null) return;
  route.value = parseRoute('#/');
  if (session.value === 'in') askedWord.value = word;
  else void signInWithWord(word).then(() => location.reload(), () => undefined);
});
effect(() => {
  if (session.value === 'in' && meta.peek() !== null) void readMeta().then(follow, () => undefined);
});
void begin(oneShotAtStart);
