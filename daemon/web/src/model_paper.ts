// SPDX-License-Identifier: MIT
// The deployed pose painted on a 2D canvas, for browsers without WebGL: triangles from far to near.
import type { Lattice } from './lattice';
import { posedPoints, Role } from './lattice';
import { cornerValues, css, mix, scaleOf, stopsOf, type Colouring, type Rgb } from './ramps';

const kAway: readonly [number, number, number] = [0.8, -0.5, 0.56];
const kLight: readonly [number, number, number] = [0.44, -0.45, 0.78];

type Vec = [number, number, number];

const dot = (a: readonly number[], b: readonly number[]): number =>
  (a[0] as number) * (b[0] as number) + (a[1] as number) * (b[1] as number) + (a[2] as number) * (b[2] as number);
const cross = (a: readonly number[], b: readonly number[]): Vec => [
  (a[1] as number) * (b[2] as number) - (a[2] as number) * (b[1] as number),
  (a[2] as number) * (b[0] as number) - (a[0] as number) * (b[2] as number),
  (a[0] as number) * (b[1] as number) - (a[1] as number) * (b[0] as number),
];
const unit = (a: readonly number[]): Vec => {
  const n = Math.hypot(...a) || 1;
  return [(a[0] as number) / n, (a[1] as number) / n, (a[2] as number) / n];
};

/** Paints `lattice` at `psi_rad` over the whole canvas. */
export function paintModel(
  canvas: HTMLCanvasElement, lattice: Lattice, psi_rad: number, colouring: Colouring, lit: ReadonlySet<number> | null,
): void {
  const context = canvas.getContext('2d');
  if (!context) return;
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  canvas.width = Math.max(1, canvas.clientWidth * ratio);
  canvas.height = Math.max(1, canvas.clientHeight * ratio);
  context.clearRect(0, 0, canvas.width, canvas.height);
  const places = posedPoints(lattice, lattice.motion === 'flat' ? Math.PI : psi_rad);
  const away = unit(kAway);
  const side = unit(cross([0, 0, 1], away));
  const up = cross(away, side);
  const n = places.length / 3;
  const px = new Float32Array(n);
  const py = new Float32Array(n);
  const depth = new Float32Array(n);
  let [left, right, bottom, top] = [Infinity, -Infinity, Infinity, -Infinity];
  for (let i = 0; i < n; i++) {
    const p = [places[3 * i] as number, places[3 * i + 1] as number, places[3 * i + 2] as number];
    px[i] = dot(p, side);
    py[i] = dot(p, up);
    depth[i] = dot(p, away);
    left = Math.min(left, px[i] as number);
    right = Math.max(right, px[i] as number);
    bottom = Math.min(bottom, py[i] as number);
    top = Math.max(top, py[i] as number);
  }
  const scale = 0.9 * Math.min(canvas.width / Math.max(1, right - left), canvas.height / Math.max(1, top - bottom));
  const x0 = canvas.width / 2 - (scale * (left + right)) / 2;
  const y0 = canvas.height / 2 + (scale * (top + bottom)) / 2;
  const m = lattice.triangle_face.length;
  const far = Float32Array.from({ length: m }, (_, t) => [0, 1, 2].reduce((sum, k) => sum + (depth[lattice.triangles[3 * t + k] as number] as number), 0));
  const order = Uint32Array.from({ length: m }, (_, t) => t).sort((a, b) => (far[a] as number) - (far[b] as number));
  const scaleUsed = scaleOf(lattice, colouring);
  const values = new Float32Array(3 * m);
  cornerValues(lattice, scaleUsed, values);
  const style = getComputedStyle(canvas);
  const ink = style.getPropertyValue('--model-cut').trim() || '#2a2824';
  const paper: Rgb = [0.985, 0.975, 0.95];
  const light = unit(kLight);
  context.lineJoin = 'round';
  for (const t of order) {
    const corner = [0, 1, 2].map((k) => lattice.triangles[3 * t + k] as number) as [number, number, number];
    const at = corner.map((i) => [places[3 * i] as number, places[3 * i + 1] as number, places[3 * i + 2] as number]) as [Vec, Vec, Vec];
    let normal = unit(cross(
      [at[1][0] - at[0][0], at[1][1] - at[0][1], at[1][2] - at[0][2]],
      [at[2][0] - at[0][0], at[2][1] - at[0][1], at[2][2] - at[0][2]],
    ));
    if (dot(normal, away) < 0) normal = [-normal[0], -normal[1], -normal[2]];
    const tone = 0.62 + 0.38 * Math.max(0, dot(normal, light));
    const value = values[3 * t] as number;
    const face = lattice.triangle_face[t] as number;
    const base = value >= 0 ? mix(stopsOf(scaleUsed), value) : paper;
    const shown: Rgb = lit?.has(face) ? [0.45 * base[0], 0.75 * base[1], 0.72 * base[2]] : base;
    context.beginPath();
    corner.forEach((i, k) => {
      const X = x0 + scale * (px[i] as number);
      const Y = y0 - scale * (py[i] as number);
      if (k === 0) context.moveTo(X, Y);
      else context.lineTo(X, Y);
    });
    context.closePath();
    context.fillStyle = css([shown[0] * tone, shown[1] * tone, shown[2] * tone]);
    context.strokeStyle = context.fillStyle;
    context.lineWidth = 0.7;
    context.fill();
    context.stroke();
    context.strokeStyle = ink;
    for (let k = 0; k < 3; k++) {
      const role = lattice.sides[3 * t + k] as number;
      if (role === Role.inside) continue;
      const a = corner[k] as number;
      const b = corner[(k + 1) % 3] as number;
      context.lineWidth = (role === Role.mountain || role === Role.valley ? 0.5 : 0.9) * ratio;
      context.setLineDash(role === Role.valley ? [3 * ratio, 3 * ratio] : role === Role.mountain ? [6 * ratio, 2 * ratio, ratio, 2 * ratio] : []);
      context.beginPath();
      context.moveTo(x0 + scale * (px[a] as number), y0 - scale * (py[a] as number));
      context.lineTo(x0 + scale * (px[b] as number), y0 - scale * (py[b] as number));
      context.stroke();
    }
    context.setLineDash([]);
  }
}
