// SPDX-License-Identifier: MIT
// The best cards of a model as pictures, to choose one from.
import { useSignal } from '@preact/signals';
import { useEffect, useId, useRef } from 'preact/hooks';
import * as desk from './design_desk';
import type { Search } from './model';
import * as opening from './model_open';
import * as outfit from './outfit';
import { OutfitChoice } from './outfit_choice';
import { Button, Choice, Meter, Picture, Trouble } from './parts';
import { kByHand, prints } from './preferences';
import * as searching from './search_desk';
import { modelOf, type Spec } from './spec';
import { may, stale } from './store';
import { percent } from './words';
import { designWords, small } from './words_design';

const words = designWords.search;

const kEases = Object.entries(words.eases) as [string, string][];
const kEfforts: [string, string][] = [[String(searching.kQuick), words.quick], [String(searching.kThorough), words.thorough]];

function Wishes({ of, again }: { of: string; again: boolean }) {
  const asked = searching.asked.value;
  const id = useId();
  const set = (some: Partial<searching.Asked>): void => { searching.asked.value = { ...asked, ...some }; };
  return (
    <form class="search-wishes" onSubmit={(event) => { event.preventDefault(); void searching.begin(of, desk.spec.peek()?.material); }}>
      <label class="field" for={`${id}m`}><span>{words.minutes}</span>
        <input id={`${id}m`} type="number" min="0.5" max="600" step="0.5" value={asked.max_minutes}
          onChange={(event) => set({ max_minutes: Math.max(0.5, Math.min(600, Number(event.currentTarget.value) || 15)) })} />
      </label>
      <Choice label={words.ease} value={asked.label} options={kEases} onChange={(label) => set({ label })} />
      <Choice label={words.cards} value={String(asked.cards)} options={searching.kCards.map((n) => [String(n), words.cardsOf(n)])}
        onChange={(n) => set({ cards: Number(n) })} />
      <Choice label={words.effort} value={String(asked.effort)} options={kEfforts} onChange={(effort) => set({ effort: Number(effort) })} />
      <OutfitChoice />
      {opening.canTurn(of) && <Button onClick={opening.turn}>{words.turn}</Button>}
      <button type="submit" class={`button ${again ? 'button-plain' : 'button-primary'}`} disabled={stale.value}>{again ? words.again : words.find}</button>
    </form>
  );
}

/** How many cards are of one sheet, and whether one of layers comes after them. */
function countsOf({ cards }: Search): [number, boolean] {
  const sheets = cards.filter(({ tabs }) => tabs === 0).length;
  return [sheets, sheets < cards.length];
}

/** Pictures side by side; arrow keys go from one to the next. */
function Found({ of }: { of: Search }) {
  const list = useRef<HTMLUListElement>(null);
  const last = of.cards.length;
  const [best] = countsOf(of);
  const shown = of.cards.findIndex((card) => desk.spec.value === card.spec as unknown as Spec);
  useEffect(() => {   // the card on the desk is in sight
    const ul = list.current!;
    const on = ul.children[shown] as HTMLElement | undefined;
    if (on) ul.scrollLeft = on.offsetLeft - ul.offsetLeft - (ul.clientWidth - on.offsetWidth) / 2;
  }, [shown]);
  return (
    <ul ref={list} class="found-cards" aria-label={words.found(last)} onKeyDown={(event) => {
      const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
      if (step === 0) return;
      const buttons = [...list.current!.querySelectorAll('button')];
      const next = buttons[buttons.indexOf(document.activeElement as HTMLButtonElement) + step];
      if (!next) return;
      event.preventDefault();
      next.focus();
    }}>
      {of.cards.map((card) => {
        const spec = card.spec as unknown as Spec;
        const on = desk.spec.value === spec;
        return (
          <li key={card.card}>
            <button type="button" class={on ? 'found-card found-on' : 'found-card'} aria-pressed={on} title={words.error(card.settings, small(card.error))}
              onClick={() => void desk.beginKept(spec, card.links.lattice)}>
              <Picture path={card.links.picture} alt={words.picture(card.card, last)} class="found-picture" />
              <span class="found-words">
                {card.card === of.recommended && <strong class="found-make" title={words.makeWhat}>{words.make}</strong>}
                {card.card === best && <span class="found-best">{words.best}</span>}
                <span class="found-what">{words.card(card.folds, card.tabs, card.shortest_fold_mm, card.hand_seconds, outfit.chosenCutter.value === kByHand ? 0 : card.seconds, card.looks)}</span>
              </span>
            </button>
          </li>
        );
      })}
    </ul>
  );
}

/** Another side than the one that was chosen would be clearly better. */
function Better({ of, front }: { of: string; front: string | null }) {
  if (front === null) return null;
  return (
    <div class="row small">
      <span>{words.better}</span>
      <Button kind="quiet" onClick={() => {
        searching.asked.value = { ...searching.asked.peek(), front };
        void searching.begin(of, desk.spec.peek()?.material);
      }}>{words.tryBetter}</Button>
    </div>
  );
}

function Running({ of }: { of: Search | null }) {
  const share = of?.progress?.share ?? null;
  const what = of?.progress?.doing ?? (of ? words.waits : words.begins);
  return (
    <div class="search-runs">
      <p role="status">{words.searching} <span class="muted">{what}{share === null ? '' : `, ${percent(share)}`}</span></p>
      <Meter share={share ?? 0} label={words.searching} />
      <Button onClick={searching.cancel}>{words.cancel}</Button>
    </div>
  );
}

/** Above a design that shows a model. */
export function SearchCards() {
  const other = useSignal(false);
  const of = modelOf(desk.spec.value);
  const mine = of !== null && searching.model.value === of;
  const search = mine ? searching.search.value : null;
  const runs = mine && searching.busy.value;
  const found = search?.state === 'found' ? search : null;
  const failed = search?.state === 'failed' ? search : null;
  const problem = mine ? searching.problem.value : null;
  // Who has not begun to work on the draft gets the card that popcut would make in place of it.
  useEffect(() => {
    const make = found?.cards.find((card) => card.card === found.recommended) ?? found?.cards.at(-1);
    if (make && searching.draft.peek() === desk.spec.peek() && !document.querySelector('dialog[open]')) void desk.beginKept(make.spec as unknown as Spec, make.links.lattice);
  }, [found?.id]);
  if (of === null || !may('submitter')) return null;
  return (
    <section class="search" aria-label={words.title}>
      <div class="row row-between">
        <h2>{words.title}</h2>
        {found && <Button kind="quiet" onClick={() => { other.value = !other.value; }}>{other.value ? designWords.close : words.otherWishes}</Button>}
      </div>
      {runs && <Running of={search} />}
      {found && !runs && (
        <>
          <p class="muted small" role="status">{words.foundWhat(...countsOf(found))}{prints.value !== 'yes' && words.asPrinted}</p>
          <Found of={found} />
          <Better of={of} front={found.better_front} />
          {found.notes.length > 0 && <ul class="plain-list small muted server-words">{found.notes.map((note) => <li key={note}>{note}</li>)}</ul>}
        </>
      )}
      {failed && !runs && (
        <div class="note note-amber" role="alert">
          <p><strong>{words.nothing}</strong></p>
          <p class="server-words">{failed.error}</p>
        </div>
      )}
      {problem && <Trouble problem={problem} onClose={() => { searching.problem.value = null; }} />}
      {!runs && (!found || other.value) && (
        <>
          {!found && !failed && !problem && <p class="muted">{words.what}</p>}
          <Wishes of={of} again={found !== null || failed !== null} />
        </>
      )}
    </section>
  );
}
