// SPDX-License-Identifier: MIT
// The right side of Design: the flat sheet, the fields, the figures, the warnings.
import { effect, useSignal } from '@preact/signals';
import type { ComponentChildren } from 'preact';
import { useEffect, useId, useLayoutEffect, useMemo, useRef } from 'preact/hooks';
import * as desk from './design_desk';
import { mustAnswer } from './drawing';
import { FaceKind, onSheet, type Lattice, type Part } from './lattice';
import * as outfit from './outfit';
import { isOn } from './parts_card';
import { SheetView, type Strokes } from './sheet_view';
import { asLattice, asPanels, asParts, isFacets, isOfParts, isPartsStyle, isPlain, isSilhouette, isSolid, scaled, slicesOf, stretched, unitsOf, widthOf, widthsOf, withField, withSlices, withSliceWidth, withUnits, withWidth, type PanelStyle, type Spec } from './spec';
import { Button, Trouble, useAsking } from './parts';
import { foldOf, go } from './route';
import { may, stale } from './store';
import { integer, length, percent, size, withoutTicks, words as everyWords } from './words';
import { designWords as words, plainNumber } from './words_design';

const kLineKinds = ['outline', 'mountain', 'valley', 'slit'];

/** What the pattern takes of the page, mm: its card, or all its lines where they reach beyond it. x, y, width, height. */
export function sheetBox(of: Lattice): [number, number, number, number] {
  const [w, h] = [of.card.width_mm, of.card.wall_mm + of.card.ground_mm];
  let [left, right, top, bottom] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < of.lines.length; i += 2) {
    top = Math.min(top, of.lines[i] as number);
    bottom = Math.max(bottom, of.lines[i] as number);
    left = Math.min(left, of.lines[i + 1] as number);
    right = Math.max(right, of.lines[i + 1] as number);
  }
  // The net of a box has a wall and a ground that are only parts of it.
  if (w > 0 && h > 0 && !(right - left > w + 1 || bottom - top > h + 1)) return [0, 0, w, h];
  return left <= right ? [left, top, right - left, bottom - top] : [0, 0, 0, 0];
}

/** The lines of a lattice, or of one of its parts, as strokes: page axes, v to the right and u down. */
export function flatStrokes(of: Lattice, part: Part | undefined): Strokes {
  const xy: number[] = [];
  const kind: number[] = [];
  for (let i = 0; i < of.line_role.length; i++) {
    const [u0, v0, u1, v1] = of.lines.subarray(4 * i, 4 * i + 4) as unknown as [number, number, number, number];
    if (part && !isOn(part, u0, v0)) continue;
    xy.push(v0, u0, v1, u1);
    kind.push((of.line_role[i] as number) - 1);
  }
  const n = kind.length;
  const box = part?.box_mm ?? sheetBox(of);
  const same = (value: number): number[] => Array.from({ length: n }, () => value);
  return {
    sheet: 1, width_mm: box[0] + box[2], length_mm: box[1] + box[3], mat: null, drawing_mm: box, kinds: kLineKinds,
    stroke: { kind, piece: same(1), pass: same(1), start_s: same(0), end_s: same(0), points: same(2) }, xy_mm: xy,
  };
}

/** The corners of all triangles of `faces` on the sheet. */
export function facesOnSheet(of: Lattice, faces: readonly number[]): Float32Array {
  const wanted = new Set(faces);
  const out: number[] = [];
  for (let t = 0; t < of.triangle_face.length; t++) {
    if (!wanted.has(of.triangle_face[t] as number)) continue;
    for (let k = 0; k < 3; k++) out.push(...onSheet(of, of.triangles[3 * t + k] as number));
  }
  return Float32Array.from(out);
}

const kSheetEvery_ms = 250;

/** The part that is looked at alone. */
function pinnedPart(of: Lattice): Part | undefined {
  const pinned = desk.pinned.value;
  return pinned?.kind === 'part' ? of.parts[pinned.part] : undefined;
}

export function FlatSheet() {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (!canvas.current) return undefined;
    const view = new SheetView(canvas.current);
    view.setOptions({ mat: false, feedEdge: false, dashed: true });
    const faceUnder = (xy: [number, number] | null): number | null => {
      const of = desk.lattice.peek();
      return of && xy ? desk.faceAt(of, xy[0], xy[1]) : null;
    };
    view.onHover = (_, xy) => {
      const face = faceUnder(xy);
      desk.hovered.value = face === null ? null : desk.litBy(face);
    };
    view.onPick = (_, xy) => {
      const of = desk.lattice.peek();
      const face = faceUnder(xy);
      const panel = of !== null && face !== null && of.face_kind[face] === FaceKind.panel;
      desk.pinned.value = panel ? desk.litBy(face as number) : null;
    };
    let shown: Lattice | null = null;
    let shownPart: Part | undefined;
    let shownAt = 0;
    let timer: ReturnType<typeof setTimeout> | undefined;
    const show = (of: Lattice | null): void => {
      const part = of ? pinnedPart(of) : undefined;
      if (of === shown && part === shownPart) return;
      shown = of;
      shownPart = part;
      shownAt = performance.now();
      view.setStrokes(of ? flatStrokes(of, part) : null);
    };
    const stops = [
      // While a hand moves, the sheet follows more slowly than the model: that is what is looked at.
      effect(() => {
        const of = desk.lattice.value;
        void desk.pinned.value;
        const wait = desk.busy.value ? kSheetEvery_ms - (performance.now() - shownAt) : 0;
        clearTimeout(timer);
        if (wait <= 0 || of === null) show(of);
        else timer = setTimeout(() => show(of), wait);
      }),
      () => clearTimeout(timer),
      effect(() => {
        const of = desk.lattice.value;
        const faces = of ? desk.litFaces(of, desk.lit.value) : null;
        const cards = of && faces ? faces.filter((f) => (of.face_kind[f] as number) === FaceKind.panel) : null;
        view.setLit(of && cards && cards.length > 0 ? facesOnSheet(of, cards) : null);
      }),
    ];
    return () => {
      for (const stop of stops) stop();
      view.dispose();
    };
  }, []);
  const of = desk.lattice.value;
  const part = of ? pinnedPart(of) : undefined;
  const box = part?.box_mm ?? (of ? sheetBox(of) : null);
  const text = box && box[2] > 0 ? size(box[2], box[3]) : '';
  return (
    <figure class="flat-sheet">
      <canvas ref={canvas} class="flat-canvas" role="img" tabIndex={0} aria-label={`${words.sheetPane}, ${text}`} />
      <figcaption class="figure">{part ? `${part.name} ${text}` : of && of.parts.length > 0 ? words.parts.all(of.parts.length) : text && words.sheetSize(text)}</figcaption>
    </figure>
  );
}

/** Reads a number that a person typed: comma or point; null if it is none. */
export function typedNumber(text: string): number | null {
  const value = Number(text.trim().replace(',', '.'));
  return text.trim() !== '' && Number.isFinite(value) ? value : null;
}

function refusedFor(...pointers: string[]): string | null {
  for (const [pointer, detail] of desk.refused.value) {
    if (pointers.some((one) => pointer === one || pointer.startsWith(`${one}/`))) return detail;
  }
  return null;
}

function Refusal({ id, text }: { id: string; text: string | null }) {
  return text === null ? null : <p id={id} class="field-refused server-words">{text}</p>;
}

function NumberField({ label, value, unit, pointers, onSet, least, disabled, title }: {
  label: string; value: number | null; unit: string; pointers: string[]; onSet: (value: number) => void; least: number; disabled?: boolean; title?: string;
}) {
  const id = useId();
  const refused = refusedFor(...pointers);
  const shown = value === null ? '' : plainNumber(Math.round(value * 100) / 100).replace(/,/g, '');
  const take = (input: HTMLInputElement): void => {
    const typed = typedNumber(input.value);
    if (typed === null || typed < least) input.value = shown;
    else if (value === null || Math.abs(typed - value) > 0.004) onSet(typed);
  };
  return (
    <div class="field field-number" title={title}>
      <label for={id}>{label}</label>
      <span class="field-box">
        <input id={id} type="text" inputMode="decimal" value={shown} disabled={disabled} aria-invalid={refused !== null}
          aria-describedby={refused ? `${id}-r` : undefined} onChange={(event) => take(event.currentTarget)}
          onKeyDown={(event) => {
            if (event.key !== 'ArrowUp' && event.key !== 'ArrowDown') return;
            event.preventDefault();
            const by = (event.shiftKey ? 0.1 : 1) * (event.key === 'ArrowUp' ? 1 : -1);
            onSet(Math.max(least, Math.round(((value ?? 0) + by) * 100) / 100));
          }} />
        <span class="field-unit">{unit}</span>
      </span>
      <Refusal id={`${id}-r`} text={refused} />
    </div>
  );
}

/** A slider that follows the hand by drafts and shows where the design stops being possible. */
function Slider({ label, field, value, least, most, step = 1, pointers, text, onMove }: {
  label: string; field: string; value: number; least: number; most: number; step?: number; pointers: string[];
  text: string; onMove: (value: number, last: boolean) => void;
}) {
  const id = useId();
  const input = useRef<HTMLInputElement>(null);
  const wall = desk.walls.value.get(field) ?? null;
  const refused = refusedFor(...pointers);
  const share = (at: number): number => Math.max(0, Math.min(1, (at - least) / (most - least)));
  useLayoutEffect(() => {
    const style = input.current?.style;
    style?.setProperty('--wall-low', `${wall?.low === null || wall?.low === undefined ? 0 : share(wall.low) * 100}%`);
    style?.setProperty('--wall-high', `${wall?.high === null || wall?.high === undefined ? 100 : share(wall.high) * 100}%`);
    style?.setProperty('--at', `${share(value) * 100}%`);
  });
  return (
    <div class="field slider">
      <label for={id}>{label}</label>
      <output for={id} class="figure">{text}</output>
      <input ref={input} id={id} type="range" min={least} max={most} step={step} value={value} aria-valuetext={text} aria-invalid={refused !== null}
        aria-describedby={refused || wall ? `${id}-r` : undefined}
        onInput={(event) => { desk.moving.value = true; onMove(Number(event.currentTarget.value), false); }}
        onChange={(event) => { onMove(Number(event.currentTarget.value), true); desk.settle(); }} />
      <Refusal id={`${id}-r`} text={refused ?? (wall?.high !== null && wall?.high !== undefined ? words.fields.wall(plainNumber(wall.high))
        : wall?.low !== null && wall?.low !== undefined ? words.fields.wall(plainNumber(wall.low)) : null)} />
    </div>
  );
}

const kLattices = ['auto', 'direct', 'levels', 'slices', 'branching', 'conformal'];

function standing(of: Lattice): { height: number; depth: number; along: number } {
  let [height, depth, low, high] = [0, 0, Infinity, -Infinity];
  for (let t = 0; t < of.triangle_face.length; t++) {
    if (of.face_kind[of.triangle_face[t] as number] !== FaceKind.panel) continue;
    for (let k = 0; k < 3; k++) {
      const p = 3 * (of.triangles[3 * t + k] as number);
      depth = Math.max(depth, of.points[p] as number);
      height = Math.max(height, of.points[p + 1] as number);
      low = Math.min(low, of.points[p + 2] as number);
      high = Math.max(high, of.points[p + 2] as number);
    }
  }
  return { height, depth, along: high > low ? high - low : 0 };
}

/** Where shapes stood in the corner of a card before they became cards of parts, which have no place for it. */
const stood = new Map<string, Pick<Spec, 'scale_mm' | 'translate_mm'>>();

/** The same shape in another style. */
function restyled(spec: Spec, style: string): Spec {
  const key = JSON.stringify([spec.surface, spec.rotate_deg]);
  if (isPartsStyle(style)) {
    if (!isOfParts(spec)) stood.set(key, { scale_mm: spec.scale_mm, translate_mm: spec.translate_mm });
    return asParts(spec, style);
  }
  const before = isOfParts(spec) ? stood.get(key) : undefined;
  const from = before ? Object.entries(before).reduce((out, [field, value]) => withField(out, field, value), spec) : spec;
  return style === 'lattice' ? asLattice(from) : asPanels(from, style as PanelStyle);
}

function StyleField({ spec }: { spec: Spec }) {
  const style = isFacets(spec) ? 'facets' : isSilhouette(spec) ? 'silhouette' : isOfParts(spec) ? String(spec.style) : 'lattice';
  return (
    <label class="field field-row">
      <span>{words.fields.style}</span>
      <select value={style} onChange={(event) => {
        const next = restyled(spec, event.currentTarget.value);
        desk.pinned.value = null;   // a part of the card before
        if (isOfParts(next)) desk.setFitting(next);   // its pages are as large as the shape asks for
        else desk.set(next);
      }}>
        <option value="lattice" selected={style === 'lattice'}>{words.fields.styleLattice}</option>
        <option value="facets" selected={style === 'facets'}>{words.fields.styleFacets}</option>
        <option value="silhouette" selected={style === 'silhouette'}>{words.fields.styleSilhouette}</option>
        <option value="layers" selected={style === 'layers'}>{words.parts.layers}</option>
        <option value="slices" selected={style === 'slices'} disabled={!isSolid(spec)}>{words.parts.slices}</option>
        <option value="boxes" selected={style === 'boxes'} disabled={!isSolid(spec)}>{words.parts.boxes}</option>
      </select>
    </label>
  );
}

/** How high an open card of parts stands. */
function heightOf(of: Lattice): number {
  let high = 0;
  for (let i = 2; i < of.points.length; i += 3) high = Math.max(high, of.frames[i] as number);   // the first frame is open
  return high;
}

/** Fields of layers, slices and boxes. */
function PartsFields({ spec, of }: { spec: Spec; of: Lattice | null }) {
  const isLayers = spec.style === 'layers';
  const key = spec.style === 'slices' ? 'sliceform' : String(spec.style);
  const own = (spec[key] ?? {}) as Record<string, unknown>;
  const number = (field: string, otherwise: number): number => (typeof own[field] === 'number' ? own[field] : otherwise);
  const withOwn = (field: string, value: unknown): Spec => withField(spec, key, withField(own, field, value));
  const slider = (field: string, label: string, otherwise: number, least: number, most: number) => (
    <Slider label={label} field={field} value={number(field, otherwise)} least={least} most={Math.max(most, number(field, otherwise))} pointers={[`/${key}/${field}`]}
      text={integer(number(field, otherwise))} onMove={(n) => desk.change(withOwn(field, n), field, n)} />
  );
  return (
    <div class="fields">
      <fieldset>
        <legend>{words.fields.fineness}</legend>
        <StyleField spec={spec} />
        {isLayers ? <>
          {slider('layers', words.fields.layers, 5, 3, 9)}
          <label class="field field-row">
            <span>{words.parts.opens}</span>
            <select value={number('opens_deg', 180)} onChange={(event) => desk.setFitting(withOwn('opens_deg', event.currentTarget.value === '90' ? 90 : null))}>
              <option value="180" selected={number('opens_deg', 180) === 180}>{words.parts.flat}</option>
              <option value="90" selected={number('opens_deg', 180) === 90}>{words.parts.corner}</option>
            </select>
          </label>
        </> : spec.style === 'boxes' ? slider('most', words.parts.most, 4, 1, 9) : <>
          {slider('x_slices', words.parts.across, 7, 2, 20)}
          {slider('y_slices', words.parts.along, 7, 2, 20)}
        </>}
      </fieldset>
      <fieldset>
        <legend>{words.fields.shape}</legend>
        <div class="field-grid">
          <NumberField label={words.fields.height} value={of && of.parts.length > 0 ? heightOf(of) : null} unit="mm" pointers={['/scale_mm']} least={1}
            title={words.fields.scales} onSet={(v) => desk.setSize(v, heightOf)} />
        </div>
        <Refusal id="surface-r" text={refusedFor('/surface', `/${key}`, '/scale_mm', '')} />
      </fieldset>
    </div>
  );
}

/** All parts of the card, with what is to do on each; a row lights its part, and a press shows its sheet alone. */
function Pieces({ of }: { of: Lattice }) {
  return (
    <section class="places" aria-labelledby="pieces">
      <h2 id="pieces">{words.parts.title}</h2>
      <p class="muted small">{words.parts.what}</p>
      <table>
        <thead><tr><th scope="col">{words.parts.piece}</th><th scope="col">{words.parts.size}</th><th scope="col">{words.figures.folds}</th><th scope="col">{words.parts.tabs}</th></tr></thead>
        <tbody>
          {of.parts.map((one, part) => (
            <tr key={one.name} class={same(desk.lit.value, { kind: 'part', part }) ? 'row-lit' : ''}>
              <th scope="row"><LitButton which={{ kind: 'part', part }} name={one.name} /></th>
              <td class="figure">{size(one.box_mm[2], one.box_mm[3])}</td>
              <td class="figure">{one.folds}</td>
              <td class="figure">{one.tabs}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </section>
  );
}

/** Lights something while one rests on it, and holds it lit when it is pressed. */
function LitButton({ which, name }: { which: desk.Lit; name: string }) {
  return <button type="button" class="link-button" aria-pressed={same(desk.pinned.value, which)}
    onPointerEnter={() => { desk.hovered.value = which; }} onPointerLeave={() => { desk.hovered.value = null; }}
    onFocus={() => { desk.hovered.value = which; }} onBlur={() => { desk.hovered.value = null; }}
    onClick={() => { desk.pinned.value = same(desk.pinned.value, which) ? null : which; }}>{name}</button>;
}

/** How finely a silhouette follows its shape. */
function LayerFields({ spec }: { spec: Spec }) {
  const own = (spec.silhouette ?? {}) as Record<string, unknown>;
  const layers = typeof own.layers === 'number' ? own.layers : 2;
  return <Slider label={words.fields.layers} field="layers" value={layers} least={1} most={9} pointers={['/silhouette/layers']}
    text={words.fields.layersText(layers)} onMove={(n) => desk.change(withField(spec, 'silhouette', { ...own, layers: n }), 'layers', n)} />;
}

/** Fields of facets and of silhouettes. */
function PanelFields({ spec, of }: { spec: Spec; of: Lattice | null }) {
  const id = useId();
  const surface = spec.surface as Record<string, unknown>;
  const facets = (spec.facets ?? {}) as Record<string, unknown>;
  const at = of ? standing(of) : null;
  const number = (value: unknown, otherwise: number): number => (typeof value === 'number' ? value : otherwise);
  const setSurface = (field: string, value: unknown): void => desk.set({ ...spec, surface: { ...surface, [field]: value } });
  const withFacet = (field: string, value: unknown): Spec => withField(spec, 'facets', withField(facets, field, value));
  const tenth = (v: number): number => Math.round(v * 10) / 10;
  return (
    <div class="fields">
      <fieldset>
        <legend>{words.fields.fineness}</legend>
        <StyleField spec={spec} />
        {isSilhouette(spec) ? <LayerFields spec={spec} /> : <>
        <Slider label={words.fields.strip} field="strip" value={number(facets.strip_mm, 2)} least={1} most={Math.max(8, number(facets.strip_mm, 2))} step={0.1}
          pointers={['/facets/strip_mm']} text={length(number(facets.strip_mm, 2))} onMove={(v) => desk.change(withFacet('strip_mm', tenth(v)), 'strip', v)} />
        <Slider label={words.fields.pitch} field="pitch" value={number(facets.pitch_mm, 2)} least={1} most={Math.max(8, number(facets.pitch_mm, 2))} step={0.1}
          pointers={['/facets/pitch_mm']} text={length(number(facets.pitch_mm, 2))} onMove={(v) => desk.change(withFacet('pitch_mm', tenth(v)), 'pitch', v)} />
        <label class="field field-row">
          <span>{words.fields.sloped}</span>
          <input type="checkbox" checked={facets.sloped === 'kites'} onChange={(event) => desk.set(withFacet('sloped', event.currentTarget.checked ? 'kites' : null))} />
        </label>
        <label class="field field-row">
          <span>{words.fields.inward}</span>
          <input type="checkbox" checked={facets.inward === true} onChange={(event) => desk.set(withFacet('inward', event.currentTarget.checked || null))} />
        </label>
        </>}
      </fieldset>
      <fieldset>
        <legend>{words.fields.shape}</legend>
        {surface.type === 'text' && (
          <div class="field field-row">
            <label for={id}>{words.fields.text}</label>
            <input id={id} type="text" maxLength={200} value={String(surface.text ?? '')}
              onChange={(event) => { const text = event.currentTarget.value.trim(); if (text !== '') setSurface('text', text); }} />
          </div>
        )}
        <div class="field-grid">
          {surface.type === 'text' ? (
            <>
              <NumberField label={words.fields.capitals} value={number(surface.height, 30)} unit="mm" pointers={['/surface/height']} least={1} onSet={(v) => setSurface('height', v)} />
              <NumberField label={words.fields.toFront} value={number(surface.depth, 15)} unit="mm" pointers={['/surface/depth']} least={1} onSet={(v) => setSurface('depth', v)} />
            </>
          ) : (
            <>
              <NumberField label={words.fields.height} value={at?.height ?? null} unit="mm" pointers={['/scale_mm']} least={1}
                title={words.fields.scales} onSet={(v) => desk.setSize(v, (one) => standing(one).height)} />
              <NumberField label={words.fields.depth} value={at?.depth ?? null} unit="mm" pointers={['/scale_mm']} least={1}
                title={words.fields.scales} onSet={(v) => desk.setSize(v, (one) => standing(one).depth)} />
            </>
          )}
        </div>
        <Refusal id="surface-r" text={refusedFor('/surface', '/facets', '/silhouette', '/card', '/scale_mm', '/translate_mm', '')} />
      </fieldset>
    </div>
  );
}

function Fields({ spec, of }: { spec: Spec; of: Lattice | null }) {
  const units = unitsOf(spec);
  const slices = slicesOf(spec);
  const width = widthOf(spec);
  const at = of ? standing(of) : null;
  const pinned = desk.pinned.value;
  const slice = pinned?.kind === 'slice' ? pinned.slice : pinned?.kind === 'face' && of ? (of.face_slice[pinned.face] as number) : null;
  const widths = widthsOf(spec);
  const splay = spec.splay as Record<string, unknown> | undefined;
  const alpha = splay && typeof splay.alpha === 'number' ? splay.alpha : null;
  const lattice = typeof spec.lattice === 'string' ? spec.lattice : 'auto';
  const latticeRefused = refusedFor('/lattice');
  const move = (next: Spec, field: string, value: number): void => desk.change(next, field, value);
  const sheet = of ? [of.card.width_mm, of.card.wall_mm + of.card.ground_mm] as const : null;
  const paper = outfit.chosenPaper.value?.title.split(',')[0] ?? '';
  const fits = (): void => {
    if (!sheet) return;
    desk.set(scaled(spec, outfit.fillFactor(...sheet)));
  };
  if (!isPlain(spec)) return <p class="note">{words.fields.notPlain}</p>;
  if (isOfParts(spec)) return <PartsFields spec={spec} of={of} />;
  if (isFacets(spec) || isSilhouette(spec)) return <PanelFields spec={spec} of={of} />;
  return (
    <div class="fields">
      <fieldset>
        <legend>{words.fields.fineness}</legend>
        <StyleField spec={spec} />
        {units !== null && <Slider label={words.fields.units} field="units" value={units} least={1} most={Math.max(14, units)} pointers={['/units_per_slice']}
          text={integer(units)} onMove={(n) => move(withUnits(spec, n), 'units', n)} />}
        {slices !== null && <Slider label={words.fields.slices} field="slices" value={slices} least={1} most={Math.max(24, slices)} pointers={['/slices']}
          text={integer(slices)} onMove={(n) => move(withSlices(spec, n), 'slices', n)} />}
        {typeof spec.min_panel_mm === 'number' && <Slider label={words.fields.minPanel} field="min_panel" value={spec.min_panel_mm} least={0.5}
          most={Math.max(8, spec.min_panel_mm)} step={0.1} pointers={['/min_panel_mm']} text={length(spec.min_panel_mm)}
          onMove={(v) => move(withField(spec, 'min_panel_mm', Math.round(v * 10) / 10), 'min_panel', v)} />}
        {alpha !== null && <Slider label={words.fields.splay} field="alpha" value={alpha} least={0.1} most={3} step={0.05} pointers={['/splay']}
          text={plainNumber(alpha)} onMove={(v) => move(withField(spec, 'splay', { ...splay, alpha: Math.round(v * 100) / 100 }), 'alpha', v)} />}
        <label class="field field-row">
          <span>{words.fields.lattice}</span>
          <select value={lattice} aria-invalid={latticeRefused !== null}
            onChange={(event) => desk.set(withField(spec, 'lattice', event.currentTarget.value === 'auto' ? null : event.currentTarget.value))}>
            {kLattices.map((name) => (
              <option key={name} value={name} selected={name === lattice}>
                {name === 'auto' ? `${words.fields.latticeAuto}${of && of.method ? ` (${of.method})` : ''}` : name}
              </option>
            ))}
          </select>
        </label>
        <Refusal id="lattice-r" text={latticeRefused} />
      </fieldset>
      <fieldset>
        <legend>{words.fields.shape}</legend>
        <div class="field-grid">
          <NumberField label={words.fields.height} value={at?.height ?? null} unit="mm" pointers={['/scale_mm']} least={1}
            title={words.fields.scales} onSet={(v) => desk.setSize(v, (of) => standing(of).height)} />
          <NumberField label={words.fields.depth} value={at?.depth ?? null} unit="mm" pointers={['/scale_mm']} least={1}
            title={words.fields.scales} onSet={(v) => desk.setSize(v, (of) => standing(of).depth)} />
          <NumberField label={words.fields.along} value={widths ? widths.reduce((sum, w) => sum + w, 0) : null} unit="mm" pointers={['/widths_mm']} least={1}
            disabled={!widths} onSet={(v) => { if (widths) desk.set(stretched(spec, v / widths.reduce((sum, w) => sum + w, 0))); }} />
          {slice !== null && slice >= 0 && widths && slice < widths.length
            ? <NumberField label={words.fields.sliceWidth(slice + 1)} value={widths[slice] as number} unit="mm" pointers={[`/widths_mm/${slice}`, '/widths_mm']} least={0.5}
              onSet={(v) => desk.set(withSliceWidth(spec, slice, v))} />
            : <NumberField label={words.fields.width} value={width} unit="mm" pointers={['/widths_mm']} least={0.5} disabled={width === null}
              onSet={(v) => desk.set(withWidth(spec, v))} />}
          <NumberField label={words.fields.angle} value={typeof spec.design_angle_deg === 'number' ? spec.design_angle_deg : 90} unit="°" pointers={['/design_angle_deg']} least={30}
            onSet={(v) => desk.set(withField(spec, 'design_angle_deg', v === 90 ? null : v))} />
          <div class="field field-end">
            <button type="button" class="button button-plain" onClick={fits} disabled={!sheet} title={words.fields.fitsWhat(paper)}>{words.fields.fits(paper)}</button>
          </div>
        </div>
        <label class="field field-row">
          <span>{words.fields.fit}</span>
          <select value={spec.fit === 'nearest' ? 'nearest' : 'exact'} onChange={(event) => desk.set(withField(spec, 'fit', event.currentTarget.value === 'nearest' ? 'nearest' : null))}>
            <option value="exact" selected={spec.fit !== 'nearest'}>{words.fields.fitExact}</option>
            <option value="nearest" selected={spec.fit === 'nearest'}>{words.fields.fitNearest}</option>
          </select>
        </label>
        <Refusal id="surface-r" text={refusedFor('/surface', '/fit', '/card', '/regions', '/patches', '/splay', '/curvature', '')} />
      </fieldset>
    </div>
  );
}

interface Report {
  fit?: { structure_to_target_mm?: { mean?: number; p95?: number }; share_within?: Record<string, number> };
  inner_error_mm?: { max?: number };
  end_error_mm?: { max?: number };
  degrees_of_freedom?: number | number[];   // of a book, each card's
  pieces?: number;
  folds?: number;
  cuts?: number;
  cut_length_mm?: number;
  fold_length_mm?: number;
  tabs?: number;
  printed?: { looks: string };
  handwork?: { folds: number; shortest_fold_mm: number; fold_s: number; label: string };
  wobble?: { largest_mm: number; mean_mm: number; loose_panels: number };   // of an exact design whose folds are parallel
}

function Row({ name, means, children }: { name: string; means?: string; children: ComponentChildren }) {
  return <div class="figure-row" title={means}><dt>{name}</dt><dd class="figure">{children}</dd></div>;
}

/** What the design is to fold, how firmly it holds in paper, and the way to its steps. */
export function ByHand({ of }: { of: Lattice }) {
  const { handwork, wobble, tabs, printed } = of.report as Report;
  const { busy, problem, run } = useAsking();
  if (!handwork) return null;
  const guide = (): Promise<void> => run(async () => { go(foldOf(await desk.storedId())); });
  return (
    <section class="by-hand" aria-labelledby="by-hand">
      <h2 id="by-hand">{words.byHand.title}</h2>
      <p>{tabs ? words.parts.byHand(handwork.folds, tabs, of.parts.length, handwork.fold_s, handwork.label)
        : everyWords.byHand(handwork.folds, handwork.shortest_fold_mm, handwork.fold_s, handwork.label)}{printed && words.parts.looks(printed.looks)}</p>
      {wobble && <p class="muted" title={words.byHand.firmWhat}>{words.byHand.firm(length(wobble.mean_mm), length(wobble.largest_mm))}{' '}
        {wobble.loose_panels > 0 && words.byHand.loose(wobble.loose_panels)}</p>}
      {problem.value && <Trouble problem={problem.value} onClose={() => { problem.value = null; }} />}
      {may('submitter') && <Button onClick={() => void guide()} disabled={busy.value || !desk.canCut.value || stale.value}>
        {busy.value ? words.byHand.storing : words.byHand.guide}</Button>}
    </section>
  );
}

export function Figures({ of }: { of: Lattice }) {
  const report = of.report as Report;
  const off = report.fit?.structure_to_target_mm;
  const within = report.fit?.share_within?.['2_percent'];
  const freedom = report.degrees_of_freedom === undefined ? undefined : Math.max(...[report.degrees_of_freedom].flat());
  return (
    <section aria-labelledby="figures">
      <h2 id="figures">{words.figures.title}</h2>
      <dl class="facts">
        {off?.mean !== undefined && <Row name={words.figures.off} means={words.figures.means.off}>{length(off.mean)}{off.p95 !== undefined && <small>{words.figures.offWhat(length(off.p95))}</small>}</Row>}
        {within !== undefined && <Row name={words.figures.within} means={words.figures.means.within}>{percent(within)}</Row>}
        {of.error_mm && of.error_mm.max > 0 && (
          <Row name={words.figures.worst} means={words.figures.means.worst}>
            {length(of.error_mm.max)}{' '}
            {of.error_mm.at && <button type="button" class="link-button" onClick={() => { desk.pinned.value = desk.litAt(of, of.error_mm?.at); }}>{words.warnings.show}</button>}
          </Row>
        )}
        {freedom !== undefined && <Row name={words.figures.freedom} means={words.figures.means.freedom}>{freedom === 1 ? words.figures.freedomOne : words.figures.freedomMany(freedom)}</Row>}
        {report.pieces !== undefined && <Row name={words.figures.pieces}>{integer(report.pieces)}</Row>}
        {of.parts.length === 0 && <Row name={words.figures.panels}>{integer(desk.panelsOf(of))}</Row>}
        {report.folds !== undefined && <Row name={words.figures.folds}>{integer(report.handwork?.folds ?? report.folds)}{report.fold_length_mm !== undefined && <small>{length(report.fold_length_mm)}</small>}</Row>}
        {report.cuts !== undefined && <Row name={words.figures.cuts}>{integer(report.cuts)}{report.cut_length_mm !== undefined && <small>{length(report.cut_length_mm)}</small>}</Row>}
        {of.parts.length === 0 && <Row name={words.figures.sheet}>{size(sheetBox(of)[2], sheetBox(of)[3])}</Row>}
      </dl>
      <details onToggle={(event) => { desk.engine.value = event.currentTarget.open; }}>
        <summary>{words.figures.engine}</summary>
        <dl class="facts">
          {report.inner_error_mm?.max !== undefined && <Row name={words.figures.inner} means={words.figures.means.inner}>{length(report.inner_error_mm.max)}</Row>}
          {report.end_error_mm?.max !== undefined && <Row name={words.figures.ends} means={words.figures.means.ends}>{length(report.end_error_mm.max)}</Row>}
        </dl>
        <p class="muted small">{words.figures.engineWhat}</p>
      </details>
    </section>
  );
}

function same(a: desk.Lit | null, b: desk.Lit): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}

/** Slices and levels with their errors; each row lights its panels. */
export function Places({ of }: { of: Lattice }) {
  const open = useSignal(false);
  const held = useRef(of);
  // Hundreds of rows that nobody sees would make each picture of a drag late.
  if (open.value || !desk.busy.value) held.current = of;
  const table = useMemo(() => (hasPlaces(held.current) ? <PlacesTable of={held.current} /> : null), [held.current]);
  return table && <details class="places" onToggle={(event) => { open.value = event.currentTarget.open; }}>
    <summary>{words.figures.slices}</summary>
    {table}
  </details>;
}

const hasPlaces = (of: Lattice): boolean => of.face_kind.some((kind, face) => kind === FaceKind.panel
  && ((of.face_slice[face] as number) >= 0 || (of.face_level[face] as number) >= 0));

function PlacesTable({ of }: { of: Lattice }) {
  const { slices, levels } = desk.errorsBy(of);
  const rows: [desk.Lit, string, number][] = [
    ...[...slices].map(([slice, error]): [desk.Lit, string, number] => [{ kind: 'slice', slice }, words.figures.slice(slice + 1), error]),
    ...[...levels].map(([level, error]): [desk.Lit, string, number] => [{ kind: 'level', level }, words.figures.level(level), error]),
  ];
  return (
    <table>
      <thead><tr><th scope="col">{words.figures.row}</th><th scope="col">{words.figures.errorOf}</th></tr></thead>
      <tbody>
        {rows.map(([which, name, error]) => (
          <tr key={name} class={same(desk.lit.value, which) ? 'row-lit' : ''}>
            <th scope="row">
              <LitButton which={which} name={name} />
            </th>
            <td class="figure">{error >= 0 ? length(error) : '–'}</td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}

export function Warnings({ of }: { of: Lattice }) {
  if (of.warnings.length === 0) return null;
  return (
    <details class="warnings" open={of.warnings.some((one) => one.spoils)}>
      <summary>{words.warnings.some(of.warnings.length)}</summary>
      <ul class="plain-list">
        {of.warnings.slice(0, 40).map((warning, i) => {
          const place = desk.litAt(of, warning.place);
          return (
            <li key={i}>
              {warning.spoils && <strong>{words.warnings.spoils} </strong>}
              <span class="server-words">{withoutTicks(warning.message).replace(/^([a-z_]+): /, (all, name: string) => (words.judged.checks[name] ? '' : all))}</span>{' '}
              {place && <button type="button" class="link-button" onClick={() => { desk.pinned.value = place; }}>{words.warnings.show}</button>}
            </li>
          );
        })}
      </ul>
    </details>
  );
}

/** "tiling: why not" with the name of the check in words. */
const withCheckWords = (text: string): string => text.replace(/^[a-z_]+/, (name) => words.judged.checks[name] ?? name);

/** Checks that say nothing of what lies flat. */
const kOfMovement = ['isometry', 'fold_angles', 'closed', 'degrees_of_freedom', 'crossing', 'opening', 'around', 'apart', 'book'];

/** What popcut judged of a pattern from elsewhere, and what not. */
export function Judged({ of }: { of: Lattice }) {
  const flat = of.motion === 'flat';
  const counts = (text: string): boolean => !flat || !kOfMovement.includes(text.split(':')[0]!);
  const isBad = (check: string): boolean => of.warnings.some(({ message }) => message.startsWith(`${check}:`));
  return (
    <section aria-labelledby="judged">
      <h2 id="judged">{flat ? words.judged.titleFlat : words.judged.title}</h2>
      <p class="note">{words.judged.stored}</p>
      <p class="muted">{flat ? of.judged.length > 0 ? words.judged.flat : words.judged.cuts : of.motion === 'frames' ? words.judged.frames : ''}</p>
      <dl class="facts">
        {of.judged.filter(counts).map((one) => <Row key={one} name={words.judged.checks[one] ?? one}>{isBad(one) ? words.judged.bad : words.judged.yes}</Row>)}
        {of.not_judged.filter(counts).map((one) => <Row key={one} name={withCheckWords(one)}>{words.judged.no}</Row>)}
        <Row name={words.figures.sheet}>{size(sheetBox(of)[2], sheetBox(of)[3])}</Row>
      </dl>
    </section>
  );
}

export function Panel() {
  const of = desk.lattice.value;
  const spec = desk.spec.value;
  const asks = mustAnswer(desk.foreign.value?.id);   // before that, what is read is a guess, and nothing of it is judged
  return (
    <aside class="design-panel">
      <FlatSheet />
      {spec && <Fields spec={spec} of={of} />}
      {of && desk.foreign.value && !asks && <Judged of={of} />}
      {of && of.parts.length > 0 && <Pieces of={of} />}
      {of && !asks && <Warnings of={of} />}
      {of && !desk.foreign.value && <ByHand of={of} />}
      {of && !desk.foreign.value && <Figures of={of} />}
      {of && <Places of={of} />}
    </aside>
  );
}
