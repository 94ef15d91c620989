// SPDX-License-Identifier: MIT
// How a design begins: from a card, from a drawn line, from a file.
import { useSignal, type Signal } from '@preact/signals';
import { useEffect, useId, useRef } from 'preact/hooks';
import { useAgain } from './again';
import * as desk from './design_desk';
import { Button, Trouble } from './parts';
import { isProblem, read, send, type ServerProblem } from './server';
import { can } from './store';
import { falling, type RadiusPoint, type Spec } from './spec';
import { words as everyWords } from './words';
import { designWords as words } from './words_design';

declare const EXAMPLE_PICTURES: Record<string, string>;
declare const EXAMPLE_GROUPS: Record<'cards' | 'paper', string[]>;

const kFirst = [...EXAMPLE_GROUPS.cards, ...EXAMPLE_GROUPS.paper];

export async function examples(): Promise<desk.Example[]> {
  const { items } = await read<{ items: desk.Example[] }>('/v1/examples');
  const rank = (name: string): number => (kFirst.includes(name) ? kFirst.indexOf(name) : kFirst.length);
  return items.slice().sort((a, b) => rank(a.name) - rank(b.name));
}

const kSpineLength = 100;
const drawn = (surface: Spec, name: string): Spec => ({
  popcut: 1, name, surface, units_per_slice: 5, slices: 10, widths_mm: kSpineLength / 10, min_panel_mm: 2.5, fit: 'nearest',
});

/** A smooth path through points, for the eye only. */
function smooth(points: readonly (readonly [number, number])[]): string {
  let out = '';
  points.forEach((p, i) => {
    if (i === 0) {
      out = `M${p[0]} ${p[1]}`;
      return;
    }
    const a = points[i - 1] as [number, number];
    const before = (points[i - 2] ?? a) as [number, number];
    const after = (points[i + 1] ?? p) as [number, number];
    const [c1x, c1y] = [a[0] + (p[0] - before[0]) / 6, a[1] + (p[1] - before[1]) / 6];
    const [c2x, c2y] = [p[0] - (after[0] - a[0]) / 6, p[1] - (after[1] - a[1]) / 6];
    out += `C${c1x.toFixed(1)} ${c1y.toFixed(1)} ${c2x.toFixed(1)} ${c2y.toFixed(1)} ${p[0].toFixed(1)} ${p[1].toFixed(1)}`;
  });
  return out;
}

function inside(event: PointerEvent, svg: SVGSVGElement): [number, number] {
  const box = svg.getBoundingClientRect();
  const view = svg.viewBox.baseVal;
  return [view.x + ((event.clientX - box.left) / box.width) * view.width, view.y + ((event.clientY - box.top) / box.height) * view.height];
}

const clamp = (value: number, low: number, high: number): number => Math.max(low, Math.min(high, value));

function onArrows(event: KeyboardEvent, by: (amount: number) => void): void {
  const step = event.shiftKey ? 0.1 : 1;
  const way = event.key === 'ArrowUp' || event.key === 'ArrowRight' ? 1 : event.key === 'ArrowDown' || event.key === 'ArrowLeft' ? -1 : 0;
  if (way === 0) return;
  event.preventDefault();
  by(way * step);
}

function Dots({ places, values, label, onBy }: {
  places: readonly (readonly [number, number])[]; values: readonly number[]; label: (k: number, n: number) => string;
  onBy: (i: number, amount: number) => void;
}) {
  return (
    <>
      {places.map(([x, y], i) => (
        <circle key={i} cx={x} cy={y} r="4.2" class="pad-dot" tabIndex={0} role="slider" aria-label={label(i + 1, places.length)}
          aria-valuenow={Math.round((values[i] as number) * 10) / 10} aria-valuemin={5} aria-valuemax={95}
          onKeyDown={(event) => onArrows(event, (amount) => onBy(i, amount))} />
      ))}
    </>
  );
}

/** Seen from above: how far the shape reaches from the spine, at places along it. */
function PlanPad() {
  const n = 7;
  const radii = useSignal<number[]>([30, 44, 53, 56, 53, 44, 30]);
  const svg = useRef<SVGSVGElement>(null);
  const last = useRef<[number, number] | null>(null);
  const set = (i: number, r: number): void => {
    radii.value = radii.value.map((old, k) => (k === i ? clamp(r, 5, 95) : old));
  };
  const pass = (event: PointerEvent): void => {
    const [x, y] = inside(event, svg.current!);
    const from = last.current ?? [x, y];
    radii.value = radii.value.map((old, k) => {
      const at = 10 + (k * kSpineLength) / (n - 1);
      const low = Math.min(x, from[0]) - (last.current ? 5 : 9);
      const high = Math.max(x, from[0]) + (last.current ? 5 : 9);
      if (at < low || at > high) return old;
      const f = x === from[0] ? 1 : clamp((at - from[0]) / (x - from[0]), 0, 1);
      return clamp(from[1] + f * (y - from[1]) - 10, 5, 95);
    });
    last.current = [x, y];
  };
  const places = radii.value.map((r, k): [number, number] => [10 + (k * kSpineLength) / (n - 1), 10 + r]);
  const use = (): void => {
    const points = radii.value.map((r, k): RadiusPoint => [Math.round(((k * kSpineLength) / (n - 1) - 5) * 100) / 100, Math.round(r * 10) / 10]);
    desk.begin(drawn({ type: 'revolution', radius: { points } }, 'drawing'), { made: true });
  };
  return (
    <article class="pad">
      <h3>{words.pads.plan}</h3>
      <p class="muted small">{words.pads.planWhat}</p>
      <svg ref={svg} viewBox="0 0 120 112" class="pad-paper" aria-label={words.pads.plan} role="group"
        onPointerDown={(event) => { svg.current!.setPointerCapture(event.pointerId); last.current = null; pass(event); }}
        onPointerMove={(event) => { if (event.buttons === 1) pass(event); }} onPointerUp={() => { last.current = null; }}>
        <line x1="6" x2="114" y1="10" y2="10" class="pad-spine" />
        <text x="6" y="7" class="pad-text">{words.pads.spine}</text>
        <path d={`${smooth(places)}L110 10L10 10Z`} class="pad-fill" />
        <path d={smooth(places)} class="pad-line" />
        <Dots places={places} values={radii.value} label={words.pads.dot} onBy={(i, amount) => set(i, (radii.value[i] as number) + amount)} />
      </svg>
      <Button onClick={use} kind="primary">{words.pads.use}</Button>
    </article>
  );
}

/** Seen from the side: the curve from the wall down to the ground. */
function ProfilePad() {
  const n = 6;
  const radii = useSignal<number[]>([70, 62, 56, 56, 62, 70]);
  const svg = useRef<SVGSVGElement>(null);
  const last = useRef<number | null>(null);
  const angle = (k: number): number => (Math.PI / 2) * (1 - k / (n - 1));
  const set = (i: number, r: number): void => {
    radii.value = radii.value.map((old, k) => (k === i ? clamp(r, 8, 95) : old));
  };
  const pass = (event: PointerEvent): void => {
    const [px, py] = inside(event, svg.current!);
    const [x, z] = [Math.max(0, px - 10), Math.max(0, 104 - py)];
    const at = Math.atan2(z, x);
    const r = Math.hypot(x, z);
    const from = last.current ?? at;
    radii.value = radii.value.map((old, k) => {
      const mine = angle(k);
      const near = last.current === null ? 0.16 : 0.06;
      return mine < Math.min(from, at) - near || mine > Math.max(from, at) + near ? old : clamp(r, 8, 95);
    });
    last.current = at;
  };
  const places = radii.value.map((r, k): [number, number] => [10 + r * Math.cos(angle(k)), 104 - r * Math.sin(angle(k))]);
  const use = (): void => {
    const line = falling(radii.value.map((r, k): [number, number] => [r * Math.cos(angle(k)), r * Math.sin(angle(k))]), n);
    const curve = line.filter((p, i) => i === 0 || p[0] !== (line[i - 1] as RadiusPoint)[0] || p[1] !== (line[i - 1] as RadiusPoint)[1])
      .map(([x, z], i, all): RadiusPoint => [i === 0 ? 0 : x, i === all.length - 1 ? 0 : z]);
    desk.begin(drawn({ type: 'profile', z: { points: curve } }, 'drawing'), { made: true });
  };
  return (
    <article class="pad">
      <h3>{words.pads.profile}</h3>
      <p class="muted small">{words.pads.profileWhat}</p>
      <svg ref={svg} viewBox="0 0 120 112" class="pad-paper" aria-label={words.pads.profile} role="group"
        onPointerDown={(event) => { svg.current!.setPointerCapture(event.pointerId); last.current = null; pass(event); }}
        onPointerMove={(event) => { if (event.buttons === 1) pass(event); }} onPointerUp={() => { last.current = null; }}>
        <path d="M10 6V104H114" class="pad-spine" fill="none" />
        <text x="13" y="11" class="pad-text">{words.pads.wall}</text>
        <text x="114" y="110" text-anchor="end" class="pad-text">{words.pads.ground}</text>
        <path d={`${smooth(places)}L10 104Z`} class="pad-fill" />
        <path d={smooth(places)} class="pad-line" />
        <Dots places={places} values={radii.value} label={words.pads.dot} onBy={(i, amount) => set(i, (radii.value[i] as number) + amount)} />
      </svg>
      <Button onClick={use} kind="primary">{words.pads.use}</Button>
    </article>
  );
}

const kRows = 8;
const kColumns = 10;

/** As a landscape: heights on a grid, higher where the hand rests. */
function HeightPad({ onProblem }: { onProblem: Signal<ServerProblem | null> }) {
  const heights = useSignal<number[]>(Array.from({ length: kRows * kColumns }, (_, i) => {
    const row = Math.floor(i / kColumns);
    return 46 * (1 - row / kRows) ** 1.3;
  }));
  const at = useSignal<[number, number]>([2, 5]);
  const svg = useRef<SVGSVGElement>(null);
  const raise = (row: number, column: number, by: number): void => {
    heights.value = heights.value.map((h, i) => {
      const d2 = (Math.floor(i / kColumns) - row) ** 2 + ((i % kColumns) - column) ** 2;
      return clamp(h + by * Math.exp(-d2 / 2.2), 0, 80);
    });
  };
  const timer = useRef<ReturnType<typeof setInterval> | undefined>(undefined);
  const held = useRef<[number, number]>([0, 0]);
  const cell = (event: PointerEvent): [number, number] => {
    const [x, y] = inside(event, svg.current!);
    return [(y - 10) / (94 / kRows) - 0.5, (x - 10) / (100 / kColumns) - 0.5];
  };
  const stop = (): void => clearInterval(timer.current);
  useEffect(() => stop, []);
  const use = async (): Promise<void> => {
    const step = 8;
    const xs = Array.from({ length: kRows + 1 }, (_, r) => r * step);
    const rows = [['', ...xs].join(',')];
    for (let c = 0; c < kColumns; c++) {
      rows.push([(c * kSpineLength) / (kColumns - 1) - 5, ...Array.from({ length: kRows }, (_, r) => (heights.value[r * kColumns + c] as number).toFixed(2)), '0'].join(','));
    }
    try {
      const asset = await send<{ id: string }>('POST', '/v1/assets?name=heights.csv', { raw: { bytes: rows.join('\n') + '\n', type: 'text/csv' } });
      desk.begin(drawn({ type: 'grid', file: asset.id }, 'landscape'), { made: true });
    } catch (error) {
      if (!isProblem(error)) throw error;
      onProblem.value = error;
    }
  };
  return (
    <article class="pad">
      <h3>{words.pads.height}</h3>
      <p class="muted small">{words.pads.heightWhat}</p>
      <svg ref={svg} viewBox="0 0 120 112" class="pad-paper" tabIndex={0} role="application"
        aria-label={`${words.pads.height}: ${words.pads.cell(at.value[0] + 1, at.value[1] + 1)}`}
        onPointerDown={(event) => {
          svg.current!.setPointerCapture(event.pointerId);
          held.current = cell(event);
          raise(...held.current, 4);
          timer.current = setInterval(() => raise(...held.current, 1.6), 60);
        }}
        onPointerMove={(event) => { held.current = cell(event); }} onPointerUp={stop} onPointerCancel={stop}
        onKeyDown={(event) => {
          const by: Record<string, [number, number]> = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] };
          const step = by[event.key];
          if (step) at.value = [clamp(at.value[0] + step[0], 0, kRows - 1), clamp(at.value[1] + step[1], 0, kColumns - 1)];
          else if (event.key === ' ' || event.key === '+') raise(...at.value, 4);
          else if (event.key === '-') raise(...at.value, -4);
          else return;
          event.preventDefault();
        }}>
        {heights.value.map((h, i) => {
          const row = Math.floor(i / kColumns);
          const column = i % kColumns;
          const here = row === at.value[0] && column === at.value[1];
          return <rect key={i} x={10 + column * 10} y={10 + row * 11.75} width="9.4" height="11.1" rx="1.5" fill-opacity={0.06 + (0.84 * h) / 80}
            class={here ? 'pad-cell pad-cell-here' : 'pad-cell'} />;
        })}
        <line x1="6" x2="114" y1="7.5" y2="7.5" class="pad-spine" />
        <text x="6" y="5.5" class="pad-text">{words.pads.wall}</text>
      </svg>
      <Button onClick={() => void use()} kind="primary">{words.pads.use}</Button>
    </article>
  );
}

/** A word that stands up, in the font that popcutd has. */
function WordPad() {
  const text = useSignal('');
  const id = useId();
  const use = (): void => {
    const word = text.peek().trim();
    if (word === '') return;
    desk.begin({
      popcut: 1, name: word.slice(0, 60), style: 'facets', facets: { min_fold_mm: 5, hinge_cost_mm3: 50 },
      surface: { type: 'text', text: word, height: 36, depth: 18 },
    }, { made: true, fits: true });
  };
  return (
    <form class="start-word" onSubmit={(event) => { event.preventDefault(); use(); }}>
      <label for={id}>{words.pads.word}</label>
      <input id={id} type="text" maxLength={40} value={text.value} placeholder="POPCUT" onInput={(event) => { text.value = event.currentTarget.value; }} />
      <button type="submit" class="button button-primary" disabled={text.value.trim() === ''}>{words.pads.wordUse}</button>
    </form>
  );
}

export function Start({ onOpen, children }: { onOpen: () => void; children?: preact.ComponentChildren }) {
  const list = useSignal<desk.Example[] | null>(null);
  const problem = useSignal<ServerProblem | null>(null);
  useEffect(() => {
    if (list.peek()) return;
    examples().then((items) => {
      list.value = items;
      problem.value = null;
    }, (error: unknown) => { if (isProblem(error)) problem.value = error; });
  }, [useAgain(problem.value)]);
  const last = desk.kept();
  return (
    <div class="design-start">
      <div class="row row-between">
        <h1>{words.start.title}</h1>
        {last && <Button kind="primary" onClick={desk.goOn}>{words.start.again}</Button>}
      </div>
      {children}
      {problem.value && <Trouble problem={problem.value} onClose={() => { problem.value = null; }} />}
      <div class="start-first">
        <section aria-label={words.start.open}>
          <Button kind="primary" big onClick={onOpen}>{words.start.open}</Button>
          <p class="muted small">{words.start.openWhat(can('queue'))}</p>
        </section>
        <WordPad />
      </div>
      <section aria-labelledby="begin">
        <h2 id="begin">{words.start.begin}</h2>
        <p class="muted">{words.start.beginWhat}</p>
        {(['cards', 'paper'] as const).map((group) => <>
        <h3>{everyWords.examples[group]}</h3>
        <ul class="start-cards">
          {(list.value ?? kFirst.map((name): desk.Example => ({ name, spec: {} }))).filter(({ name }) => EXAMPLE_GROUPS.cards.includes(name) === (group === 'cards')).map((example) => (
            <li key={example.name}>
              <button type="button" class="start-card" disabled={!list.value} onClick={() => desk.begin(example.spec)}>
                <span class="start-picture">
                  {EXAMPLE_PICTURES[example.name] && <img src={EXAMPLE_PICTURES[example.name]} alt="" width="360" height="300" />}
                </span>
                <span class="start-name">{example.title ?? example.name}</span>
              </button>
            </li>
          ))}
        </ul>
        </>)}
      </section>
      <section aria-labelledby="draw">
        <h2 id="draw">{words.start.draw}</h2>
        <p class="muted">{words.start.drawWhat}</p>
        <div class="pads"><PlanPad /><ProfilePad /><HeightPad onProblem={problem} /></div>
      </section>
    </div>
  );
}
