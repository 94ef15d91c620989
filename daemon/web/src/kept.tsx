// SPDX-License-Identifier: MIT
// What this browser keeps of a person's work: to look through, to carry elsewhere, to delete.
import { useSignal } from '@preact/signals';
import { useEffect, useRef, useState } from 'preact/hooks';
import type { Design } from './model';
import { Button, Dialog, Picture, Trouble, useAct } from './parts';
import { read, readBlob, saveAs, send, type ServerProblem } from './server';
import { dateTime } from './words';
import { keptWords as say } from './words_kept';

export function Kept() {
  const designs = useSignal<Design[]>([]);
  const taken = useSignal<number | null>(null);
  const sure = useSignal(false);
  const [problem, setProblem] = useState<ServerProblem | null>(null);
  const { busy, run } = useAct(setProblem);
  const file = useRef<HTMLInputElement>(null);
  const load = (): void => void run(async () => { designs.value = (await read<{ items: Design[] }>('/v1/designs')).items; });
  useEffect(load, []);
  const change = (what: () => Promise<unknown>): void => void run(what).then((done) => { if (done) load(); });
  const take = (from: File): void => change(async () => {
    taken.value = (await send<{ designs: number }>('POST', '/v1/kept', { raw: { bytes: from, type: 'application/zip' } })).designs;
  });
  return (
    <section class="card">
      <h2>{say.title}</h2>
      <p class="muted">{say.what}</p>
      {problem && <Trouble problem={problem} onClose={() => setProblem(null)} />}
      {taken.value !== null && <p class="note note-good" role="status">{say.taken(taken.value)}</p>}
      {designs.value.length === 0 ? <p>{say.none}</p> : (
        <ul class="plain-list">
          {designs.value.map((one) => (
            <li key={one.id} class="row row-between">
              <Picture path={`/v1/designs/${one.id}/deployed.svg`} alt="" class="picture-small" />
              <span class="kept-name"><a href={`#/design/${one.id}`}>{one.name || say.unnamed}</a> <span class="muted">{dateTime(Date.parse(one.created))}</span></span>
              <Button kind="quiet" disabled={busy} label={`${say.forget}: ${one.name || say.unnamed}`}
                onClick={() => change(() => send('DELETE', `/v1/designs/${one.id}`))}>{say.forget}</Button>
            </li>
          ))}
        </ul>
      )}
      <div class="row">
        <Button kind="primary" disabled={busy || designs.value.length === 0}
          onClick={() => void run(async () => saveAs(await readBlob('/v1/kept'), say.file))}>{say.save}</Button>
        <Button disabled={busy} onClick={() => file.current?.click()}>{say.open}</Button>
        <Button kind="quiet" disabled={busy || designs.value.length === 0} onClick={() => { sure.value = true; }}>{say.clear}</Button>
      </div>
      <input ref={file} type="file" class="visually-hidden" tabIndex={-1} aria-hidden="true" accept=".zip"
        onChange={(event) => {
          const chosen = event.currentTarget.files?.[0];
          event.currentTarget.value = '';
          if (chosen) take(chosen);
        }} />
      {sure.value && (
        <Dialog title={say.sure} yes={say.clear} onNo={() => { sure.value = false; }}
          onYes={() => { sure.value = false; change(() => send('DELETE', '/v1/kept')); }}>
          <p>{say.sureWhat}</p>
        </Dialog>
      )}
    </section>
  );
}
