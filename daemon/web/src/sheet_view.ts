// SPDX-License-Identifier: MIT
// A sheet as it lies on the mat, drawn from its strokes: what is planned, what became of each, and
// the cut played back. Canvas 2D; one Path2D for each kind of line; draws only when something changed.
import { size as sizeText } from './words';
import { endOf, strokeAt, strokeNumber, strokesAt, strokeStarts, type Strokes } from './strokes';
import { sheetWords } from './words_sheet';

export * from './strokes';

/** Ranges [from, to) of stroke numbers. `done`: strokes before it are probably cut. */
export interface Fates {
  certain: [number, number][];
  doubt: [number, number][];
  done: number;
}

export interface SheetOptions {
  /** Folds are whole lines: draw them dashed. (In strokes each dash is a stroke.) */
  dashed?: boolean;
  /** Shows the way of the tool between strokes. */
  travel?: boolean;
  /** Colours strokes by when they are cut. */
  byTime?: boolean;
  /** Marks the edge that is fed first. */
  feedEdge?: boolean;
  /** Only these kinds are drawn in full; the others are faint. */
  only?: readonly string[] | null;
  /** Draws the mat around the drawing; else the drawing's own sheet only. */
  mat?: boolean;
}

/** "valley fold 211 of 330". */
export function strokeWords(strokes: Strokes, i: number): string {
  const { kind, nth, of } = strokeNumber(strokes, i);
  const names = sheetWords.kinds as Record<string, string>;
  return sheetWords.stroke(names[kind] ?? names['other'] ?? kind, nth, of);
}

interface Theme {
  paper: string; mat: string; line: string; ink: string; muted: string; accent: string; amber: string;
  cut: string; mountain: string; valley: string; other: string; late: string;
}

type Ink = 'cut' | 'mountain' | 'valley' | 'other';

function inkOf(kind: string | undefined): Ink {
  if (kind === 'cut' || kind === 'outline' || kind === 'slit') return 'cut';
  if (kind === 'mountain' || kind === 'valley') return kind;
  return 'other';
}

const kInks: readonly Ink[] = ['other', 'valley', 'mountain', 'cut'];
const kTimeBands = 12;
const kTapPixels = 22;
const kMargin = 18;
const kArrow = 34;

export class SheetView {
  onPick: ((stroke: number | null, xy_mm: [number, number]) => void) | null = null;
  onHover: ((stroke: number | null, xy_mm: [number, number] | null) => void) | null = null;
  private readonly canvas: HTMLCanvasElement;
  private readonly context: CanvasRenderingContext2D | null;
  private readonly observer: ResizeObserver;
  private readonly themes: MutationObserver;
  private readonly scheme = matchMedia('(prefers-color-scheme: dark)');
  private strokes: Strokes | null = null;
  private starts: Int32Array = new Int32Array(1);
  private fates: Fates | null = null;
  private time: number | null = null;
  private options: SheetOptions = { mat: true, feedEdge: true };
  private marked: number | null = null;
  private lensOn: number | null = null;
  private lit: Float32Array | null = null;
  private ghost: Float32Array | null = null;
  private pulseFrom = 0;
  private theme: Theme | null = null;
  private requested = 0;
  private scale = 1;
  private left = 0;
  private top = 0;
  private fitted = true;
  private classes: Map<Ink, Path2D> | null = null;
  private bands: Path2D[] | null = null;
  private travelPath: Path2D | null = null;
  private played: { begun: number; paths: Map<Ink, Path2D> } | null = null;
  private fatePaths: { certain: Path2D; doubt: Path2D; sent: Path2D; rest: Path2D } | null = null;
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private moved = 0;
  private pinch = 0;

  constructor(canvas: HTMLCanvasElement) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas);
    this.themes = new MutationObserver(this.retheme);
    this.themes.observe(document.documentElement, { attributes: true });
    this.scheme.addEventListener('change', this.retheme);
    canvas.addEventListener('pointerdown', this.onDown);
    canvas.addEventListener('pointermove', this.onMove);
    canvas.addEventListener('pointerup', this.onUp);
    canvas.addEventListener('pointercancel', this.onUp);
    canvas.addEventListener('pointerleave', this.onLeave);
    canvas.addEventListener('wheel', this.onWheel, { passive: false });
    canvas.addEventListener('dblclick', this.onDouble);
    canvas.addEventListener('keydown', this.onKey);
    this.resize();
  }

  setStrokes(strokes: Strokes | null): void {
    const other = strokes?.width_mm !== this.strokes?.width_mm || strokes?.length_mm !== this.strokes?.length_mm;
    this.strokes = strokes;
    this.starts = strokes ? strokeStarts(strokes) : new Int32Array(1);
    this.classes = this.bands = null;
    this.travelPath = null;
    this.played = null;
    this.fatePaths = null;
    if (this.fitted || other) this.fit();
    this.request();
  }

  setFates(fates: Fates | null): void {
    this.fates = fates;
    this.fatePaths = null;
    this.request();
  }

  /** Shows the sheet as it is `seconds` after the start; null: all of it. */
  setTime(seconds: number | null): void {
    if (seconds === this.time) return;
    this.time = seconds;
    this.request();
  }

  setOptions(options: SheetOptions): void {
    this.options = { ...this.options, ...options };
    if (this.fitted) this.fit();
    this.request();
  }

  /** One stroke emphasised, with an arrow. */
  setMarked(stroke: number | null): void {
    if (stroke === this.marked) return;
    this.marked = stroke;
    this.request();
  }

  /** A round glass that shows the middle of a stroke in true size. */
  setLens(stroke: number | null): void {
    if (stroke === this.lensOn) return;
    this.lensOn = stroke;
    this.request();
  }

  /** Triangles that are lit, six numbers each: x, y of the corners, mm. */
  setLit(triangles: Float32Array | null): void {
    if (triangles === null && this.lit === null) return;
    this.lit = triangles;
    this.request();
  }

  /** Triangles of a shadow: where something comes to lie. */
  setShadow(triangles: Float32Array | null): void {
    this.ghost = triangles;
    this.request();
  }

  /** Lets the marked stroke flash once; not where reduced motion is asked for. */
  pulse(): void {
    if (matchMedia('(prefers-reduced-motion: reduce)').matches) return;
    this.pulseFrom = performance.now();
    this.request();
  }

  describe(): string {
    const { strokes, fates } = this;
    if (!strokes) return sheetWords.empty;
    const n = strokes.stroke.points.length;
    const text = sheetWords.sentence(n, sizeText(strokes.width_mm, strokes.length_mm));
    if (!fates) return text;
    const sum = (ranges: [number, number][]): number => ranges.reduce((all, [from, to]) => all + to - from, 0);
    const certain = sum(fates.certain);
    const doubt = sum(fates.doubt);
    return `${text}; ${sheetWords.fates(certain, doubt, Math.max(0, n - certain - doubt))}`;
  }

  /** All of the sheet in the canvas. */
  fit(): void {
    this.fitted = true;
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    const [x, y, w, h] = this.frame();
    const scale = Math.min((width - 2 * kMargin) / w, (height - 2 * kMargin) / h);
    this.scale = Number.isFinite(scale) && scale > 0 ? scale : 1;
    this.left = (width - w * this.scale) / 2 - x * this.scale;
    this.top = (height - h * this.scale) / 2 - y * this.scale;
    this.canvas.style.touchAction = 'pan-y';
    this.request();
  }

  /** CSS pixels for each mm at true size, if a mm of this screen is what CSS says. */
  trueSize(): void {
    const { strokes } = this;
    if (!strokes) return;
    const [x, y, w, h] = strokes.drawing_mm;
    const to = 96 / 25.4;
    this.zoomAbout(to / this.scale, 0, 0);
    this.left = this.canvas.clientWidth / 2 - (x + w / 2) * to;
    this.top = this.canvas.clientHeight / 2 - (y + h / 2) * to;
    this.request();
  }

  /** Where a place of the canvas, in CSS pixels, lies on the sheet. */
  toSheet(px: number, py: number): [number, number] {
    return [(px - this.left) / this.scale, (py - this.top) / this.scale];
  }

  get mmPerPixel(): number {
    return 1 / this.scale;
  }

  dispose(): void {
    if (this.requested) cancelAnimationFrame(this.requested);
    this.observer.disconnect();
    this.themes.disconnect();
    this.scheme.removeEventListener('change', this.retheme);
    const { canvas } = this;
    canvas.removeEventListener('pointerdown', this.onDown);
    canvas.removeEventListener('pointermove', this.onMove);
    canvas.removeEventListener('pointerup', this.onUp);
    canvas.removeEventListener('pointercancel', this.onUp);
    canvas.removeEventListener('pointerleave', this.onLeave);
    canvas.removeEventListener('wheel', this.onWheel);
    canvas.removeEventListener('dblclick', this.onDouble);
    canvas.removeEventListener('keydown', this.onKey);
  }

  private frame(): [number, number, number, number] {
    const { strokes } = this;
    if (!strokes) return [0, 0, 100, 100];
    if (this.options.mat === false) {
      const [x, y, w, h] = strokes.drawing_mm;
      return [x, y, Math.max(w, 1), Math.max(h, 1)];
    }
    return [0, 0, Math.max(strokes.width_mm, 1), Math.max(strokes.length_mm, 1)];
  }

  private readonly retheme = (): void => {
    this.theme = null;
    this.request();
  };

  private colours(): Theme {
    if (this.theme) return this.theme;
    const style = getComputedStyle(this.canvas);
    const get = (name: string, fallback: string): string => style.getPropertyValue(name).trim() || fallback;
    this.theme = {
      paper: get('--sheet', '#ffffff'),
      mat: get('--mat', '#e4e8e6'),
      line: get('--line', '#c9c5bb'),
      ink: get('--ink', '#26241f'),
      muted: get('--muted', '#6d695f'),
      accent: get('--accent', '#1f6aa8'),
      amber: get('--amber', '#b06f00'),
      cut: get('--cut', '#26241f'),
      mountain: get('--mountain', '#b8352a'),
      valley: get('--valley', '#1f5fa8'),
      other: get('--muted', '#6d695f'),
      late: get('--late', '#d98b1f'),
    };
    return this.theme;
  }

  private resize(): void {
    const ratio = Math.min(3, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    if (this.fitted) this.fit();
    this.request();
  }

  private request(): void {
    if (this.requested === 0) this.requested = requestAnimationFrame(this.draw);
  }

  private addStroke(path: Path2D, i: number, share = 1): void {
    const xy = this.strokes?.xy_mm;
    if (!xy) return;
    const from = this.starts[i] as number;
    const to = this.starts[i + 1] as number;
    if (to - from < 2) return;
    path.moveTo(xy[from] as number, xy[from + 1] as number);
    if (to - from === 2) {
      path.lineTo((xy[from] as number) + 0.01, xy[from + 1] as number);
      return;
    }
    if (share >= 1) {
      for (let p = from + 2; p < to; p += 2) path.lineTo(xy[p] as number, xy[p + 1] as number);
      return;
    }
    let left = share * this.lengthOf(i);
    for (let p = from + 2; p < to && left > 0; p += 2) {
      const ax = xy[p - 2] as number;
      const ay = xy[p - 1] as number;
      const bx = xy[p] as number;
      const by = xy[p + 1] as number;
      const d = Math.hypot(bx - ax, by - ay);
      const f = d > left ? left / d : 1;
      path.lineTo(ax + f * (bx - ax), ay + f * (by - ay));
      left -= d;
    }
  }

  private lengthOf(i: number): number {
    const xy = this.strokes?.xy_mm ?? [];
    let out = 0;
    for (let p = (this.starts[i] as number) + 2; p < (this.starts[i + 1] as number); p += 2) {
      out += Math.hypot((xy[p] as number) - (xy[p - 2] as number), (xy[p + 1] as number) - (xy[p - 1] as number));
    }
    return out;
  }

  private inkAt(i: number): Ink {
    return inkOf(this.strokes?.kinds[this.strokes.stroke.kind[i] as number]);
  }

  private byKind(): Map<Ink, Path2D> {
    if (this.classes) return this.classes;
    const out = new Map<Ink, Path2D>(kInks.map((ink) => [ink, new Path2D()]));
    const n = this.starts.length - 1;
    for (let i = 0; i < n; i++) this.addStroke(out.get(this.inkAt(i)) as Path2D, i);
    this.classes = out;
    return out;
  }

  private byTime(): Path2D[] {
    if (this.bands) return this.bands;
    const out = Array.from({ length: kTimeBands }, () => new Path2D());
    const all = endOf(this.strokes) || 1;
    const n = this.starts.length - 1;
    for (let i = 0; i < n; i++) {
      const at = (this.strokes?.stroke.start_s[i] ?? 0) / all;
      this.addStroke(out[Math.min(kTimeBands - 1, Math.floor(at * kTimeBands))] as Path2D, i);
    }
    this.bands = out;
    return out;
  }

  private travels(): Path2D {
    if (this.travelPath) return this.travelPath;
    const out = new Path2D();
    const xy = this.strokes?.xy_mm ?? [];
    for (let i = 1; i + 1 < this.starts.length; i++) {
      const from = (this.starts[i] as number) - 2;
      const to = this.starts[i] as number;
      out.moveTo(xy[from] as number, xy[from + 1] as number);
      out.lineTo(xy[to] as number, xy[to + 1] as number);
    }
    this.travelPath = out;
    return out;
  }

  private fatesOf(fates: Fates): NonNullable<SheetView['fatePaths']> {
    if (this.fatePaths) return this.fatePaths;
    const n = this.starts.length - 1;
    const fate = new Uint8Array(n);
    fate.fill(1, 0, Math.max(0, Math.min(n, fates.done)));
    for (const [from, to] of fates.certain) fate.fill(3, Math.max(0, from), Math.min(n, to));
    for (const [from, to] of fates.doubt) fate.fill(2, Math.max(0, from), Math.min(n, to));
    const out = { certain: new Path2D(), doubt: new Path2D(), sent: new Path2D(), rest: new Path2D() };
    const paths = [out.rest, out.sent, out.doubt, out.certain];
    for (let i = 0; i < n; i++) this.addStroke(paths[fate[i] as number] as Path2D, i);
    this.fatePaths = out;
    return out;
  }

  private readonly draw = (): void => {
    this.requested = 0;
    const c = this.context;
    if (!c) return;
    const theme = this.colours();
    const ratio = this.canvas.width / Math.max(1, this.canvas.clientWidth);
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    if (!this.strokes) return;
    c.setTransform(ratio * this.scale, 0, 0, ratio * this.scale, ratio * this.left, ratio * this.top);
    c.lineCap = 'round';
    c.lineJoin = 'round';
    this.drawGround(c, theme);
    this.drawLines(c, theme, this.scale);
    this.drawMarked(c, theme, this.scale);
    if (this.lensOn !== null) this.drawLens(c, theme, ratio);
    if (this.pulseFrom > 0) {
      if (performance.now() - this.pulseFrom > 900) this.pulseFrom = 0;
      this.request();
    }
  };

  private drawGround(c: CanvasRenderingContext2D, theme: Theme): void {
    const { strokes } = this;
    if (!strokes) return;
    const px = 1 / this.scale;
    if (this.options.mat === false) {
      const [x, y, w, h] = strokes.drawing_mm;
      c.save();
      c.shadowColor = 'rgb(40 34 20 / 22%)';
      c.shadowBlur = 14 * (this.canvas.width / Math.max(1, this.canvas.clientWidth));
      c.shadowOffsetY = 3;
      c.fillStyle = theme.paper;
      c.fillRect(x, y, w, h);
      c.restore();
    } else {
      const { width_mm: w, length_mm: h } = strokes;
      c.fillStyle = theme.mat;
      c.beginPath();
      c.roundRect(0, 0, w, h, 6 * px);
      c.fill();
      c.strokeStyle = theme.line;
      c.lineWidth = px;
      c.stroke();
      this.drawGrid(c, theme, w, h, px);
      const [dx, dy, dw, dh] = strokes.drawing_mm;
      c.fillStyle = theme.paper;
      c.fillRect(dx, dy, dw, dh);
      if (this.options.feedEdge) this.drawFeedEdge(c, theme, w, px);
    }
    if (this.lit) this.fillTriangles(c, this.lit, theme.accent, 0.28);
    if (this.ghost) this.fillTriangles(c, this.ghost, theme.amber, 0.3);
  }

  private drawGrid(c: CanvasRenderingContext2D, theme: Theme, w: number, h: number, px: number): void {
    const step = 25.4 * (this.scale * 25.4 < 14 ? 2 : 1);
    c.globalAlpha = 0.45;
    c.beginPath();
    for (let x = step; x < w - 0.1; x += step) {
      c.moveTo(x, 0);
      c.lineTo(x, h);
    }
    for (let y = step; y < h - 0.1; y += step) {
      c.moveTo(0, y);
      c.lineTo(w, y);
    }
    c.lineWidth = 0.75 * px;
    c.strokeStyle = theme.line;
    c.stroke();
    c.globalAlpha = 1;
  }

  private drawFeedEdge(c: CanvasRenderingContext2D, theme: Theme, w: number, px: number): void {
    c.fillStyle = theme.accent;
    c.fillRect(0, 0, w, 3 * px);
    const at = w / 2;
    c.beginPath();
    c.moveTo(at, 6 * px);
    c.lineTo(at - 6 * px, 14 * px);
    c.lineTo(at + 6 * px, 14 * px);
    c.closePath();
    c.fill();
    c.font = `600 ${12 * px}px system-ui, sans-serif`;
    c.textBaseline = 'top';
    c.fillText(sheetWords.feedEdge, at + 12 * px, 6 * px);
  }

  private fillTriangles(c: CanvasRenderingContext2D, corners: Float32Array, colour: string, alpha: number): void {
    c.globalAlpha = alpha;
    c.fillStyle = colour;
    c.beginPath();
    for (let i = 0; i + 5 < corners.length; i += 6) {
      c.moveTo(corners[i] as number, corners[i + 1] as number);
      c.lineTo(corners[i + 2] as number, corners[i + 3] as number);
      c.lineTo(corners[i + 4] as number, corners[i + 5] as number);
      c.closePath();
    }
    c.fill();
    c.globalAlpha = 1;
  }

  private drawLines(c: CanvasRenderingContext2D, theme: Theme, scale: number): void {
    const px = 1 / scale;
    if (this.time !== null) {
      this.drawPlayed(c, theme, px);
      return;
    }
    if (this.fates) {
      this.drawFates(c, theme, this.fates, px);
      return;
    }
    if (this.options.travel) this.drawTravel(c, theme, px);
    if (this.options.byTime) {
      this.byTime().forEach((path, i) => {
        c.strokeStyle = timeColour(i / (kTimeBands - 1));
        c.lineWidth = 1.4 * px;
        c.stroke(path);
      });
      return;
    }
    const only = this.options.only?.map(inkOf);
    for (const [ink, path] of this.byKind()) this.strokeInk(c, theme, ink, path, px, only && !only.includes(ink) ? 0.18 : 1);
  }

  private strokeInk(c: CanvasRenderingContext2D, theme: Theme, ink: Ink, path: Path2D, px: number, alpha: number): void {
    c.globalAlpha = alpha;
    c.strokeStyle = theme[ink];
    c.lineWidth = (ink === 'cut' ? 1.1 : 1.4) * px;
    if (this.options.dashed && ink === 'mountain') c.setLineDash([7 * px, 3 * px, 1.5 * px, 3 * px]);
    if (this.options.dashed && ink === 'valley') c.setLineDash([4.5 * px, 3.5 * px]);
    if (this.options.dashed) c.lineCap = 'butt';
    c.stroke(path);
    c.setLineDash([]);
    c.globalAlpha = 1;
  }

  private drawTravel(c: CanvasRenderingContext2D, theme: Theme, px: number): void {
    c.globalAlpha = 0.4;
    c.strokeStyle = theme.accent;
    c.lineWidth = 0.75 * px;
    c.setLineDash([2 * px, 3 * px]);
    c.stroke(this.travels());
    c.setLineDash([]);
    c.globalAlpha = 1;
  }

  private drawFates(c: CanvasRenderingContext2D, theme: Theme, fates: Fates, px: number): void {
    const paths = this.fatesOf(fates);
    c.strokeStyle = theme.muted;
    c.globalAlpha = 0.45;
    c.lineWidth = 0.8 * px;
    c.stroke(paths.rest);
    c.globalAlpha = 1;
    // Sent, but not known to be cut: hollow.
    c.strokeStyle = theme.ink;
    c.lineWidth = 3.4 * px;
    c.stroke(paths.sent);
    c.strokeStyle = theme.paper;
    c.lineWidth = 1.4 * px;
    c.stroke(paths.sent);
    // In doubt: thick amber, hatched by dashes on top.
    c.strokeStyle = theme.amber;
    c.globalAlpha = 0.35;
    c.lineWidth = 8 * px;
    c.stroke(paths.doubt);
    c.globalAlpha = 1;
    c.lineCap = 'butt';
    c.lineWidth = 6 * px;
    c.setLineDash([1.5 * px, 3.5 * px]);
    c.stroke(paths.doubt);
    c.setLineDash([]);
    c.lineCap = 'round';
    c.strokeStyle = theme.ink;
    c.lineWidth = 1.8 * px;
    c.stroke(paths.certain);
  }

  private drawPlayed(c: CanvasRenderingContext2D, theme: Theme, px: number): void {
    const { strokes } = this;
    if (!strokes || this.time === null) return;
    c.globalAlpha = 0.22;
    c.strokeStyle = theme.muted;
    c.lineWidth = 0.8 * px;
    for (const path of this.byKind().values()) c.stroke(path);
    c.globalAlpha = 1;
    const { begun, share } = strokesAt(strokes, this.time);
    const whole = Math.max(0, begun - 1);
    if (!this.played || this.played.begun > whole) {
      this.played = { begun: 0, paths: new Map(kInks.map((ink) => [ink, new Path2D()])) };
    }
    for (let i = this.played.begun; i < whole; i++) this.addStroke(this.played.paths.get(this.inkAt(i)) as Path2D, i);
    this.played.begun = whole;
    if (this.options.byTime) {
      const all = endOf(strokes) || 1;
      const parts = Array.from({ length: kTimeBands }, () => new Path2D());
      for (let i = 0; i < whole; i++) {
        const at = (strokes.stroke.start_s[i] as number) / all;
        this.addStroke(parts[Math.min(kTimeBands - 1, Math.floor(at * kTimeBands))] as Path2D, i);
      }
      parts.forEach((path, i) => {
        c.strokeStyle = timeColour(i / (kTimeBands - 1));
        c.lineWidth = 1.5 * px;
        c.stroke(path);
      });
    } else {
      for (const [ink, path] of this.played.paths) this.strokeInk(c, theme, ink, path, px, 1);
    }
    if (this.options.travel && begun > 1) {
      c.save();
      const path = new Path2D();
      for (let i = 1; i < begun; i++) {
        const to = this.starts[i] as number;
        path.moveTo(strokes.xy_mm[to - 2] as number, strokes.xy_mm[to - 1] as number);
        path.lineTo(strokes.xy_mm[to] as number, strokes.xy_mm[to + 1] as number);
      }
      c.globalAlpha = 0.4;
      c.strokeStyle = theme.accent;
      c.lineWidth = 0.75 * px;
      c.setLineDash([2 * px, 3 * px]);
      c.stroke(path);
      c.restore();
    }
    if (begun > 0) this.drawTool(c, theme, begun - 1, share, px);
  }

  /** The stroke that is being cut, and the tool at its end, or on the way to the next one. */
  private drawTool(c: CanvasRenderingContext2D, theme: Theme, i: number, share: number, px: number): void {
    const { strokes } = this;
    if (!strokes || this.time === null) return;
    const path = new Path2D();
    this.addStroke(path, i, share);
    this.strokeInk(c, theme, this.inkAt(i), path, px, 1);
    let [x, y] = this.placeOn(i, share);
    const next = i + 1 < this.starts.length - 1 ? (strokes.stroke.start_s[i + 1] as number) : null;
    const end = strokes.stroke.end_s[i] as number;
    const up = share >= 1 && next !== null && this.time > end;
    if (up && next !== null) {
      const f = next > end ? (this.time - end) / (next - end) : 1;
      const to = this.starts[i + 1] as number;
      x += f * ((strokes.xy_mm[to] as number) - x);
      y += f * ((strokes.xy_mm[to + 1] as number) - y);
    }
    c.beginPath();
    c.arc(x, y, 4.5 * px, 0, 2 * Math.PI);
    c.fillStyle = up ? theme.paper : theme.accent;
    c.fill();
    c.strokeStyle = theme.accent;
    c.lineWidth = 1.6 * px;
    c.stroke();
  }

  /** The place on stroke `i` after `share` of its length, mm. */
  private placeOn(i: number, share: number): [number, number] {
    const xy = this.strokes?.xy_mm ?? [];
    const from = this.starts[i] as number;
    const to = this.starts[i + 1] as number;
    let left = share * this.lengthOf(i);
    for (let p = from + 2; p < to; p += 2) {
      const ax = xy[p - 2] as number;
      const ay = xy[p - 1] as number;
      const bx = xy[p] as number;
      const by = xy[p + 1] as number;
      const d = Math.hypot(bx - ax, by - ay);
      if (d >= left && d > 0) return [ax + (left / d) * (bx - ax), ay + (left / d) * (by - ay)];
      left -= d;
    }
    return [xy[to - 2] ?? 0, xy[to - 1] ?? 0];
  }

  private drawMarked(c: CanvasRenderingContext2D, theme: Theme, scale: number): void {
    if (this.marked === null || this.marked < 0 || this.marked >= this.starts.length - 1) return;
    const px = 1 / scale;
    const path = new Path2D();
    this.addStroke(path, this.marked);
    const since = this.pulseFrom > 0 ? (performance.now() - this.pulseFrom) / 900 : 1;
    if (since < 1) {
      c.globalAlpha = 0.5 * (1 - since);
      c.strokeStyle = theme.accent;
      c.lineWidth = (6 + 30 * since) * px;
      c.stroke(path);
      c.globalAlpha = 1;
    }
    c.strokeStyle = theme.accent;
    c.lineWidth = 3.2 * px;
    c.stroke(path);
    const [x, y] = this.placeOn(this.marked, 0);
    // An arrow from the nearer side, so that it stays on the sheet.
    const from = x * scale + this.left > 60 ? -1 : 1;
    c.fillStyle = theme.accent;
    c.beginPath();
    c.moveTo(x + from * 3 * px, y);
    c.lineTo(x + from * 14 * px, y - 7 * px);
    c.lineTo(x + from * 14 * px, y - 2 * px);
    c.lineTo(x + from * 32 * px, y - 2 * px);
    c.lineTo(x + from * 32 * px, y + 2 * px);
    c.lineTo(x + from * 14 * px, y + 2 * px);
    c.lineTo(x + from * 14 * px, y + 7 * px);
    c.closePath();
    c.fill();
  }

  private drawLens(c: CanvasRenderingContext2D, theme: Theme, ratio: number): void {
    if (this.lensOn === null || this.lensOn >= this.starts.length - 1) return;
    const [x, y] = this.placeOn(this.lensOn, 0.5);
    const px = x * this.scale + this.left;
    const py = y * this.scale + this.top;
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    const r = Math.min(96, width * 0.3, height * 0.3);
    const beside = (side: number): number => Math.min(width - r - 6, Math.max(r + 6, px + side * (r + 28)));
    const cy = Math.min(height - r - 6, Math.max(r + 6, py));
    // Where there is room, but not over the arrow at the start of the stroke.
    const [sx, sy] = this.placeOn(this.lensOn, 0);
    const clears = (x_: number): boolean => Math.hypot(sx * this.scale + this.left - x_, sy * this.scale + this.top - cy) > r + kArrow;
    const side = px < width / 2 ? 1 : -1;
    const cx = beside(clears(beside(side)) || !clears(beside(-side)) ? side : -side);
    const to = Math.max(96 / 25.4, 1.5 * this.scale);
    c.save();
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.strokeStyle = theme.accent;
    c.lineWidth = 1.5;
    c.beginPath();
    c.moveTo(px, py);
    c.lineTo(cx, cy);
    c.stroke();
    c.beginPath();
    c.arc(cx, cy, r, 0, 2 * Math.PI);
    c.shadowColor = 'rgb(0 0 0 / 30%)';
    c.shadowBlur = 16 * ratio;
    c.fillStyle = theme.paper;
    c.fill();
    c.shadowBlur = 0;
    c.clip();
    c.setTransform(ratio * to, 0, 0, ratio * to, ratio * (cx - x * to), ratio * (cy - y * to));
    this.drawLines(c, theme, to);
    const path = new Path2D();
    this.addStroke(path, this.lensOn);
    c.strokeStyle = theme.accent;
    c.lineWidth = 3 / to;
    c.stroke(path);
    c.restore();
    c.save();
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.beginPath();
    c.arc(cx, cy, r, 0, 2 * Math.PI);
    c.strokeStyle = theme.accent;
    c.lineWidth = 2;
    c.stroke();
    c.restore();
  }

  private zoomAbout(factor: number, x: number, y: number): void {
    const least = Math.min(
      (this.canvas.clientWidth - 2 * kMargin) / this.frame()[2],
      (this.canvas.clientHeight - 2 * kMargin) / this.frame()[3],
    );
    const next = Math.min(Math.max(this.scale * factor, least), least * 60);
    if (next <= least * 1.001) {
      this.fit();
      return;
    }
    const f = next / this.scale;
    this.left = x - f * (x - this.left);
    this.top = y - f * (y - this.top);
    this.scale = next;
    this.fitted = false;
    this.canvas.style.touchAction = 'none';
    this.request();
  }

  private panBy(dx: number, dy: number): void {
    if (this.fitted) return;
    this.left += dx;
    this.top += dy;
    this.request();
  }

  private place(event: MouseEvent): { x: number; y: number } {
    const box = this.canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  }

  private readonly onDown = (event: PointerEvent): void => {
    this.pointers.set(event.pointerId, this.place(event));
    if (this.pointers.size === 1) this.moved = 0;
    if (this.pointers.size === 2) {
      this.pinch = this.spread();
      this.moved = 100;
    }
    this.canvas.setPointerCapture?.(event.pointerId);
  };

  private spread(): number {
    const [a, b] = [...this.pointers.values()];
    return a && b ? Math.hypot(a.x - b.x, a.y - b.y) : 0;
  }

  private readonly onMove = (event: PointerEvent): void => {
    const at = this.place(event);
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      if (this.onHover && event.pointerType !== 'touch') this.onHover(this.strokeNear(at.x, at.y), this.toSheet(at.x, at.y));
      return;
    }
    this.moved += Math.hypot(at.x - before.x, at.y - before.y);
    if (this.pointers.size === 2) {
      this.pointers.set(event.pointerId, at);
      const [a, b] = [...this.pointers.values()];
      const now = this.spread();
      if (a && b && this.pinch > 0) this.zoomAbout(now / this.pinch, (a.x + b.x) / 2, (a.y + b.y) / 2);
      this.pinch = now;
      this.panBy((at.x - before.x) / 2, (at.y - before.y) / 2);
      return;
    }
    this.pointers.set(event.pointerId, at);
    this.panBy(at.x - before.x, at.y - before.y);
  };

  private readonly onUp = (event: PointerEvent): void => {
    if (!this.pointers.delete(event.pointerId)) return;
    if (event.type === 'pointerup' && this.pointers.size === 0 && this.moved < 6 && this.onPick) {
      const at = this.place(event);
      this.onPick(this.strokeNear(at.x, at.y), this.toSheet(at.x, at.y));
    }
  };

  private readonly onLeave = (): void => {
    this.onHover?.(null, null);
  };

  private strokeNear(px: number, py: number): number | null {
    if (!this.strokes) return null;
    const [x, y] = this.toSheet(px, py);
    return strokeAt(this.strokes, x, y, kTapPixels / this.scale);
  }

  private readonly onWheel = (event: WheelEvent): void => {
    // A plain wheel scrolls the page until the sheet is magnified; with Ctrl (a pinch on a pad) it magnifies.
    if (!event.ctrlKey && this.fitted && event.deltaY > 0) return;
    event.preventDefault();
    const at = this.place(event);
    this.zoomAbout(Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.0016)), at.x, at.y);
  };

  private readonly onDouble = (event: MouseEvent): void => {
    const at = this.place(event);
    if (this.fitted) this.zoomAbout(3, at.x, at.y);
    else this.fit();
  };

  private readonly onKey = (event: KeyboardEvent): void => {
    const middle = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2] as const;
    if (event.key === '+' || event.key === '=') this.zoomAbout(1.4, ...middle);
    else if (event.key === '-') this.zoomAbout(1 / 1.4, ...middle);
    else if (event.key === '0') this.fit();
    else if (!this.fitted && event.key.startsWith('Arrow')) {
      const by = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] }[event.key];
      if (!by) return;
      this.panBy(by[0] as number, by[1] as number);
    } else return;
    event.preventDefault();
  };
}

/** Early: dark blue; late: amber. Lightness rises with time. */
export function timeColour(share: number): string {
  const stops = [[34, 45, 98], [70, 96, 140], [125, 124, 120], [190, 150, 70], [232, 178, 50]];
  const at = Math.min(0.9999, Math.max(0, share)) * (stops.length - 1);
  const i = Math.floor(at);
  const f = at - i;
  const a = stops[i] as number[];
  const b = stops[i + 1] as number[];
  return `rgb(${a.map((part, k) => Math.round(part + f * ((b[k] as number) - part))).join(' ')})`;
}
