// SPDX-License-Identifier: MIT
// Questions about a model that is opened: which one is meant, and how it is to stand.
import { useSignal } from '@preact/signals';
import { useRef } from 'preact/hooks';
import { frontsOf, nameOf, type Axis } from './model_files';
import * as opening from './model_open';
import { OutfitChoice } from './outfit_choice';
import { Button, Dialog } from './parts';
import { designWords } from './words_design';

const words = designWords.standing;
const kListed = 12;

function Side({ of, up, front, onPick, small }: {
  of: opening.Question; up: Axis; front: Axis; onPick: () => void; small?: boolean;
}) {
  const address = of.pictures.get(opening.pictureKey(up, front));
  const isGuess = !small && front === of.guess;
  return (
    <button type="button" class={`side${isGuess ? ' side-guess' : ''}${small ? ' side-small' : ''}`} onClick={onPick}
      aria-label={small ? words.standsOn(up) : words.faces(front, isGuess)}>
      {address ? <img src={address} alt="" width="320" height="320" /> : <span class="side-name">{small ? words.standsOn(up) : words.faces(front, false)}</span>}
      {isGuess && <span class="side-word">{words.guess}</span>}
    </button>
  );
}

function Lacks({ of, clay, onAdd, onClay }: { of: opening.Question; clay: boolean; onAdd: () => void; onClay: () => void }) {
  const { lacks } = of.read;
  if (lacks.length === 0 || clay) return clay ? <p class="note small" role="status">{words.inClay}</p> : null;
  const name = nameOf(of.given.path);
  return (
    <div class="note note-amber" role="alert">
      {lacks.slice(0, 3).map((lack) => <p key={lack.kind + lack.name}>{words.lacks[lack.kind](lack.name, name, lack.pixels)}</p>)}
      {lacks.length > 3 && <p>{words.more(lacks.length - 3)}</p>}
      <div class="row">
        <Button onClick={onAdd}>{words.add}</Button>
        <Button onClick={onClay}>{words.clay}</Button>
      </div>
    </div>
  );
}

function Standing({ of, onSaid }: { of: opening.Question; onSaid: (said: opening.Said) => void }) {
  const more = useRef<HTMLInputElement>(null);
  const clay = useSignal(false);
  const busy = useSignal(false);
  const run = async (what: Promise<opening.Said>): Promise<void> => {
    busy.value = true;
    const said = await what;
    busy.value = false;
    if (said !== null) onSaid(said);
  };
  const answer = (front: Axis | null): void => {
    if (!busy.peek()) void run(opening.answer(front, clay.peek()));
  };
  return (
    <Dialog title={words.title} onNo={opening.forget} no={words.cancel} yes={words.any} kind="plain" onYes={() => answer(null)} busy={busy.value} wide>
      <p>{words.what}</p>
      <Lacks of={of} clay={clay.value} onAdd={() => more.current?.click()} onClay={() => { clay.value = true; }} />
      <input ref={more} type="file" multiple class="visually-hidden" tabIndex={-1} aria-hidden="true" data-more accept=".mtl,.zip,image/*"
        onChange={(event) => {
          const files = [...event.currentTarget.files ?? []];
          event.currentTarget.value = '';
          void run(opening.add(files.map((file) => ({ path: file.name, file }))));
        }} />
      <div class="sides">
        {frontsOf(of.up).map((front) => <Side key={front} of={of} up={of.up} front={front} onPick={() => answer(front)} />)}
      </div>
      <p class="muted small">{words.other}</p>
      <div class="sides sides-small">
        {opening.kUps.filter((up) => up !== of.up).map((up) => (
          <Side key={up} of={of} up={up} front={frontsOf(up)[0] as Axis} onPick={() => void opening.standOn(up)} small />
        ))}
      </div>
      <OutfitChoice />
      {busy.value && <p class="muted" role="status">{opening.doing.value}</p>}
    </Dialog>
  );
}

function Several({ onSaid }: { onSaid: (said: opening.Said) => void }) {
  const of = opening.several.value;
  if (!of) return null;
  const close = (): void => { opening.several.value = null; };
  return (
    <Dialog title={of.title} onNo={close} no={words.cancel}>
      <ul class="export-list">
        {of.of.slice(0, kListed).map((one) => (
          <li key={one.path}><button type="button" class="export" onClick={() => void of.open(one).then((said) => { if (said !== null) onSaid(said); })}>
            {one.path}</button></li>
        ))}
      </ul>
      {of.of.length > kListed && <p class="muted small">{words.more(of.of.length - kListed)}</p>}
    </Dialog>
  );
}

/** What is asked about files that were given. */
export function Questions({ onSaid }: { onSaid: (said: opening.Said) => void }) {
  const of = opening.question.value;
  return <>
    <Several onSaid={onSaid} />
    {of && <Standing of={of} onSaid={onSaid} />}
  </>;
}
