// Done: what ended, newest first, and who used how much.
import { useEffect, useState } from 'preact/hooks';
import { useAgain } from './again';
import type { Job, UsageRow } from './model';
import { Button, Choice, Loading, Picture, Trouble } from './parts';
import { glueOf, sheetsOf } from './route';
import { isProblem, read, readBlob, saveAs, type ServerProblem } from './server';
import { deviceTitle, jobs, localTime, ownerOf, recentlyDone } from './store';
import { dateTime, duration, integer, metres, words } from './words';

type By = 'owner' | 'device' | 'material';

interface Page<T> { items: T[]; next_cursor?: string | null }

function Ended({ job }: { job: Job }) {
  return (
    <li class="job-row">
      <Picture path={job.design ? `/v1/designs/${encodeURIComponent(job.design)}/deployed.svg` : null} alt=""
        class="picture-row" />
      <div class="job-what">
        <strong class="job-name">{job.name ?? words.unnamed}</strong>
        <span class="next-line">
          <span class={`state state-${job.state}`}>{job.outcome && job.outcome !== job.state ? job.outcome : words.states[job.state]}</span>
          {job.finished && <span>{dateTime(localTime(job.finished))}</span>}
          <span class="muted">{ownerOf(job)}</span>
          {job.device && <span class="muted">{deviceTitle(job.device)}</span>}
          {job.material && <span class="muted">{job.material}</span>}
          {job.sheets_total > 0 && <span class="muted">{words.sheets(job.sheets_total)}</span>}
        </span>
        {job.state === 'failed' && job.reason && <span class="server-words">{words.reasons[job.reason] ?? job.reason}</span>}
      </div>
      {job.plan && (
        <div class="job-end">
          {job.state === 'done' && <a href={glueOf(job.plan)}>{words.machine.howToFold}</a>}
          <a href={sheetsOf(job.plan)}>{words.now.plan}</a>
        </div>
      )}
    </li>
  );
}

/** `list`: jobs that tell how the people are called. */
function Usage({ list }: { list: Job[] }) {
  const [by, setBy] = useState<By>('owner');
  const [rows, setRows] = useState<UsageRow[] | null>(null);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const ended = recentlyDone.value;
  useEffect(() => {
    const stop = new AbortController();
    read<Page<UsageRow>>(`/v1/usage?by=${by}`, { signal: stop.signal }).then(({ items }) => {
      setRows(items);
      setProblem(null);
    }, (error) => { if (isProblem(error)) setProblem(error); });
    return () => stop.abort();
  }, [by, ended, useAgain(problem)]);
  const save = (): void => {
    readBlob(`/v1/usage?by=${by}`, { accept: 'text/csv' }).then((blob) => saveAs(blob, words.done.csvName),
      (error) => { if (isProblem(error)) setProblem(error); });
  };
  const people = new Map([...jobs.value.values(), ...ended, ...list].map((job) => [job.owner, ownerOf(job)]));
  const title = (key: string): string => (by === 'device' ? deviceTitle(key) : by === 'owner' ? people.get(key) ?? key : key);
  const names = words.done.columns;
  const sum = (of: (row: UsageRow) => number): number => (rows ?? []).reduce((all, row) => all + of(row), 0);
  return (
    <section>
      <h2>{words.done.usage}</h2>
      <div class="row">
        <Choice label={words.done.by} value={by} onChange={setBy} options={[['owner', words.done.byOwner],
          ['device', words.done.byDevice], ['material', words.done.byMaterial]]} />
        <Button onClick={save}>{words.done.csv}</Button>
      </div>
      {problem && <Trouble problem={problem} />}
      {rows && rows.length > 0 && (
        <div class="table-box" tabIndex={0} role="region" aria-label={words.done.usage}>
          <table class="figures">
            <thead><tr><th scope="col">{names.key}</th><th scope="col">{names.time}</th><th scope="col">{names.cut}</th>
              <th scope="col">{names.sheets}</th></tr></thead>
            <tbody>
              {rows.map((row) => (
                <tr key={row.key}><th scope="row">{title(row.key)}</th>
                  <td>{duration(row.seconds)}</td><td>{metres(row.cut_mm)}</td><td>{integer(row.sheets)}</td></tr>
              ))}
            </tbody>
            {rows.length > 1 && (
              <tfoot><tr><th scope="row">{words.done.total}</th><td>{duration(sum((row) => row.seconds))}</td>
                <td>{metres(sum((row) => row.cut_mm))}</td><td>{integer(sum((row) => row.sheets))}</td></tr></tfoot>
            )}
          </table>
        </div>
      )}
    </section>
  );
}

export function Done() {
  const [list, setList] = useState<Job[] | null>(null);
  const [cursor, setCursor] = useState<string | null>(null);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const more = (from: string | null): void => {
    const where = from ? `&cursor=${encodeURIComponent(from)}` : '';
    read<Page<Job>>(`/v1/jobs?state=done,failed,cancelled&order=desc&limit=30${where}`).then((page) => {
      setList((known) => [...(from ? known ?? [] : []), ...page.items]);
      setCursor(page.next_cursor ?? null);
      setProblem(null);
    }, (error) => { if (isProblem(error)) setProblem(error); });
  };
  const newest = recentlyDone.value[0]?.id;
  useEffect(() => more(null), [newest, useAgain(problem)]);
  return (
    <div class="done">
      <h1>{words.done.title}</h1>
      <div class="two-columns">
        <section>
          <h2 class="visually-hidden">{words.done.jobs}</h2>
          {problem && <Trouble problem={problem} />}
          {list === null ? !problem && <Loading /> : list.length === 0 ? <p class="muted">{words.done.empty}</p>
            : <ul class="job-list">{list.map((job) => <Ended key={job.id} job={job} />)}</ul>}
          {cursor && <Button onClick={() => more(cursor)}>{words.done.more}</Button>}
        </section>
        <Usage list={list ?? []} />
      </div>
    </div>
  );
}
