// SPDX-License-Identifier: MIT
// The steps from cut sheets to a card, from plan.json: pure.

export type Affine = [[number, number, number], [number, number, number]];
export type Line = [number, number][];

export interface PlanSheet {
  pieces?: { piece: number; transform: Affine }[];
  tabs?: { seam: string; piece: number; under: number; points: Line }[];
  seams?: { seam: string; piece: number; other: number; points: Line; glued?: Line[] }[];
}

export interface PlanFile {
  name?: string;
  sheets: PlanSheet[];
  layout?: { steps?: string[][]; seams?: { seam: string; pieces: number[] }[] };
}

/** One side of a seam: where it lies on its sheet, and the tabs that come to lie under it or reach out of it. */
export interface SeamSide {
  sheet: number;
  piece: number;
  edges: Line[];
  tabs: Line[];
  /** Tabs of the other side, where they come to lie under this piece. */
  shadows: Line[];
}

export type GlueStep =
  | { kind: 'waste'; sheets: number }
  | { kind: 'mountains' | 'valleys'; folds: number }
  | { kind: 'seam'; letter: string; sides: SeamSide[] }
  | { kind: 'weight' }
  | { kind: 'open' }
  | { kind: 'shape' };

const kMostSteps = 400;

export function apply(t: Affine, [x, y]: readonly [number, number]): [number, number] {
  return [t[0][0] * x + t[0][1] * y + t[0][2], t[1][0] * x + t[1][1] * y + t[1][2]];
}

/** The inverse of a turn with a shift; null where it has none. */
export function inverse(t: Affine): Affine | null {
  const [[a, b, c], [d, e, f]] = t;
  const det = a * e - b * d;
  if (!(Math.abs(det) > 1e-12)) return null;
  return [[e / det, -b / det, (b * f - e * c) / det], [-d / det, a / det, (d * c - a * f) / det]];
}

function pieceAt(plan: PlanFile, piece: number): { sheet: number; transform: Affine } | null {
  for (const [i, sheet] of plan.sheets.entries()) {
    const found = sheet.pieces?.find((one) => one.piece === piece);
    if (found) return { sheet: i + 1, transform: found.transform };
  }
  return null;
}

/** Both sides of a seam. */
export function seamSides(plan: PlanFile, letter: string): SeamSide[] {
  const sides: SeamSide[] = [];
  for (const [i, sheet] of plan.sheets.entries()) {
    for (const seam of sheet.seams ?? []) {
      if (seam.seam !== letter) continue;
      const edges = seam.glued && seam.glued.length > 0 ? seam.glued : [seam.points];
      const known = sides.find((side) => side.sheet === i + 1 && side.piece === seam.piece);
      if (known) known.edges.push(...edges);
      else sides.push({ sheet: i + 1, piece: seam.piece, edges: [...edges], tabs: [], shadows: [] });
    }
  }
  for (const [i, sheet] of plan.sheets.entries()) {
    for (const tab of sheet.tabs ?? []) {
      if (tab.seam !== letter) continue;
      sides.find((side) => side.sheet === i + 1 && side.piece === tab.piece)?.tabs.push(tab.points);
      const own = pieceAt(plan, tab.piece);
      const under = pieceAt(plan, tab.under);
      const back = own && inverse(own.transform);
      const there = sides.find((side) => side.piece === tab.under);
      if (back && under && there) there.shadows.push(tab.points.map((p) => apply(under.transform, apply(back, p))));
    }
  }
  return sides;
}

/** All steps: free the waste, crease, glue seam by seam in the plan's order; press and open what `shuts`, fold up anything else. */
export function glueSteps(plan: PlanFile, folds: { mountains: number; valleys: number }, shuts = true): GlueStep[] {
  const steps: GlueStep[] = [{ kind: 'waste', sheets: plan.sheets.length }];
  if (folds.mountains > 0) steps.push({ kind: 'mountains', folds: folds.mountains });
  if (folds.valleys > 0) steps.push({ kind: 'valleys', folds: folds.valleys });
  const told = (plan.layout?.steps ?? []).flat();
  const all = [...new Set([...told, ...plan.sheets.flatMap((sheet) => (sheet.seams ?? []).map((seam) => seam.seam))])];
  for (const letter of all.slice(0, kMostSteps)) steps.push({ kind: 'seam', letter, sides: seamSides(plan, letter) });
  if (folds.mountains + folds.valleys > 0) steps.push(...(shuts ? [{ kind: 'weight' } as const, { kind: 'open' } as const] : [{ kind: 'shape' } as const]));
  return steps;
}

/** Thin bands along lines and fans over closed ones, as triangles of six numbers. */
export function bands(lines: readonly Line[], width_mm: number): Float32Array {
  const out: number[] = [];
  for (const line of lines) {
    for (let i = 1; i < line.length; i++) {
      const [ax, ay] = line[i - 1] as [number, number];
      const [bx, by] = line[i] as [number, number];
      const d = Math.hypot(bx - ax, by - ay);
      if (d === 0) continue;
      const nx = (-(by - ay) / d) * (width_mm / 2);
      const ny = ((bx - ax) / d) * (width_mm / 2);
      out.push(ax + nx, ay + ny, bx + nx, by + ny, bx - nx, by - ny, ax + nx, ay + ny, bx - nx, by - ny, ax - nx, ay - ny);
    }
  }
  return Float32Array.from(out);
}

export function fans(polygons: readonly Line[]): Float32Array {
  const out: number[] = [];
  for (const polygon of polygons) {
    for (let i = 2; i < polygon.length; i++) {
      out.push(...(polygon[0] as [number, number]), ...(polygon[i - 1] as [number, number]), ...(polygon[i] as [number, number]));
    }
  }
  return Float32Array.from(out);
}
