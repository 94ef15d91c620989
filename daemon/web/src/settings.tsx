// Settings: of this browser, of tablets, and what this page is.
import type { ComponentType } from 'preact';
import { useEffect, useState } from 'preact/hooks';
import { Button, Choice, Note, Trouble, useAct } from './parts';
import { beside, language, theme, units } from './preferences';
import { isProblem, read, send, signOut, type ServerProblem } from './server';
import type { Role, SessionListed } from './model';
import { includes } from './model';
import { can, devices, localTime, me, meta, stale } from './store';
import { loadKept } from './backend';
import { dateTime, words } from './words';

const kRoles: Role[] = ['viewer', 'submitter', 'operator', 'admin'];

function Display() {
  const say = words.settings;
  return (
    <section class="card">
      <h2>{say.display}</h2>
      <Choice label={say.units} value={units.value} onChange={(value) => { units.value = value; }}
        options={[['mm', say.mm], ['inch', say.inch]]} />
      <Choice label={say.theme} value={theme.value} onChange={(value) => { theme.value = value; }}
        options={[['system', say.system], ['light', say.light], ['dark', say.dark]]} />
      <Choice label={say.language} value={language.value}
        onChange={(value) => { language.value = value; location.reload(); }}
        options={language.value === 'pseudo' ? [['en', say.english], ['pseudo', say.pseudo]] : [['en', say.english]]} />
      {can('devices') && <Choice label={say.beside} value={beside.value} onChange={(value) => { beside.value = value; }}
        options={[['', say.besideNone], ...[...devices.value.values()].map((one): [string, string] => [one.id, one.title])]} />}
      {can('devices') && <p class="muted">{say.besideWhat}</p>}
    </section>
  );
}

function Allow() {
  const say = words.settings;
  const mine = me.value?.role ?? 'viewer';
  const roles = kRoles.filter((role) => includes(mine, role));
  const [code, setCode] = useState('');
  const [role, setRole] = useState<Role>(includes(mine, 'operator') ? 'operator' : mine);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const [done, setDone] = useState<{ name: string; role: string } | null>(null);
  const { busy, run } = useAct(setProblem);
  const allow = (): void => {
    setDone(null);
    void run(async () => {
      setDone(await send<{ name: string; role: string }>('POST', '/v1/session/pair/allow',
        { body: { code: code.replace(/[^A-Za-z0-9]/g, '').toUpperCase(), role } }));
      setCode('');
    });
  };
  return (
    <form class="stack" onSubmit={(event) => { event.preventDefault(); allow(); }}>
      <p>{say.allowWhat}</p>
      <div class="row">
        <label class="field"><span>{say.code}</span>
          <input class="code-input" value={code} maxLength={9} autocomplete="off" autocapitalize="characters"
            spellcheck={false} onInput={(event) => setCode(event.currentTarget.value)} /></label>
        <Choice label={say.role} value={role} onChange={setRole}
          options={roles.map((one): [Role, string] => [one, words.roles[one] ?? one])} />
        <button type="submit" class="button button-primary" disabled={busy || stale.value || code.trim().length < 6}>
          {say.allow}
        </button>
      </div>
      {problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}
      {done && <Note kind="good"><p role="status">{say.allowed(done.name, words.roles[done.role] ?? done.role)}</p></Note>}
    </form>
  );
}

function Sessions() {
  const say = words.settings;
  const [list, setList] = useState<SessionListed[]>([]);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const { busy, run } = useAct(setProblem);
  const load = (): void => {
    read<{ items: SessionListed[] }>('/v1/sessions').then(({ items }) => setList(items),
      (error) => { if (isProblem(error)) setProblem(error); });
  };
  useEffect(load, []);
  const end = (id: string): void => {
    void run(() => send('DELETE', `/v1/sessions/${encodeURIComponent(id)}`)).then(load);
  };
  return (
    <>
      <h3>{say.sessions}</h3>
      {problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}
      <ul class="plain-list">
        {list.map((one) => (
          <li key={one.id} class="row row-between">
            <span>
              {(one as SessionListed & { name?: string | null }).name ? `${(one as SessionListed & { name?: string }).name}: ` : ''}
              {say.session(words.roles[one.role] ?? one.role, dateTime(localTime(one.created)))}
              <span class="muted"> {say.ends(dateTime(localTime(one.expires)))}</span>
            </span>
            <Button kind="quiet" disabled={busy || stale.value} onClick={() => end(one.id)}>{say.end}</Button>
          </li>
        ))}
      </ul>
      <Button onClick={() => void signOut()}>{say.endThis}</Button>
    </>
  );
}

function About() {
  const say = words.settings;
  const licences = document.querySelector<HTMLLinkElement>('link[rel=license]')?.href;
  return (
    <section class="card">
      <h2>{say.about}</h2>
      {can('users') && me.value && <p>{words.person(me.value.title ?? me.value.name, words.roles[me.value.role] ?? me.value.role)}</p>}
      {meta.value && <p>{can('queue') ? say.build(meta.value.build) : `popcut ${meta.value.build}`}{meta.value.page ? ` · ${meta.value.page}` : ''}</p>}
      {licences && <p><a href={licences} target="_blank" rel="noopener">{say.licences}</a></p>}
    </section>
  );
}

function KeptHere() {
  const [View, setView] = useState<ComponentType | null>(null);
  useEffect(() => { void loadKept?.().then(({ Kept }) => setView(() => Kept)); }, []);
  return View && <View />;
}

export default function Settings() {
  return (
    <div class="settings">
      <h1>{words.settings.title}</h1>
      <div class="cards">
        <Display />
        <KeptHere />
        {can('users') && <section class="card">
          <h2>{words.settings.tablets}</h2>
          <Allow />
          <Sessions />
        </section>}
        <About />
      </div>
    </div>
  );
}
