// SPDX-License-Identifier: MIT
// A design in three dimensions: one mesh of unindexed triangles that opens and shuts by one uniform.
// Lines are drawn in the fragment shader from the distance to the triangle's sides. While something
// moves, one frame is drawn for each change; once it rests, some frames with moved lights are
// gathered into one picture with soft shadows, and then nothing is drawn any more.
import {
  AddEquation,
  BufferAttribute,
  BufferGeometry,
  ColorManagement,
  CustomBlending,
  DataTexture,
  DepthTexture,
  DoubleSide,
  FloatType,
  FrontSide,
  GLSL3,
  HalfFloatType,
  LessEqualCompare,
  LinearFilter,
  Matrix4,
  Mesh,
  NearestFilter,
  NoBlending,
  OneMinusSrcAlphaFactor,
  OrthographicCamera,
  PerspectiveCamera,
  RawShaderMaterial,
  RGBAFormat,
  Scene,
  SrcAlphaFactor,
  UnsignedByteType,
  Vector2,
  Vector3,
  Vector4,
  WebGLRenderer,
  WebGLRenderTarget,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import type { Lattice } from './lattice';
import { frameAt, posedPoints } from './lattice';
import { cornersOf, drawOrder, largestUpTo, light, ordered, sameTopology, tintCorners, type DrawOrder } from './model_mesh';
import {
  copyFragmentShader, depthFragmentShader, ghostFragmentShader, ghostVertexShader, kFaint_px, modelVertexShader,
  paperFragmentShader, paperVertexShader, screenVertexShader, tableFragmentShader, tableVertexShader, whoFragmentShader,
  whoVertexShader,
} from './model_shaders';
import { scaleOf, type Colouring, type Rgb, type Scale } from './ramps';

export interface Lit {
  face?: number | null;
  slice?: number | null;
  level?: number | null;
}

export interface ModelOptions {
  /** A face under the pointer, or null. */
  onHover?: (face: number | null) => void;
  onPick?: (face: number | null, event: PointerEvent) => void;
  /** After each drawn picture: places of handles can have moved. */
  onDraw?: () => void;
  onLost?: () => void;
  onRestored?: () => void;
}

// Colours are given and mixed as they are shown; the shaders do their own light.
ColorManagement.enabled = false;

/** Frames that are gathered once the picture rests; fewer where one takes long. */
const kGathered = 40;
const kGatheredSlow = 14;
const kSlow_ms = 70;
/** If a picture takes longer, those of something that moves are drawn with fewer pixels. */
const kSmooth_ms = 36;
/** Only what rests so long gets its soft shadows. */
const kRest_ms = 300;
/** Beyond this the light of the sky is not gathered: each frame costs two more passes. */
const kMostGatheredTriangles = 60_000;
const kShadowPixels = 1024;
const kFieldOfView_deg = 24;

/** A number in 0..1 for each i, evenly spread for every leading run: the radical inverse to `base`. */
function halton(i: number, base: number): number {
  let f = 1;
  let out = 0;
  for (let n = i; n > 0; n = Math.floor(n / base)) {
    f /= base;
    out += f * (n % base);
  }
  return out;
}

function readColour(style: CSSStyleDeclaration, name: string, fallback: Rgb): Vector3 {
  const text = style.getPropertyValue(name).trim();
  const hex = /^#([0-9a-f]{6})$/i.exec(text);
  if (!hex) return new Vector3(...fallback);
  const n = Number.parseInt(hex[1] as string, 16);
  return new Vector3(((n >> 16) & 255) / 255, ((n >> 8) & 255) / 255, (n & 255) / 255);
}

/** True where the processor draws in place of a graphics card. */
function drawnBySoftware(gl: WebGLRenderingContext | WebGL2RenderingContext): boolean {
  const info = gl.getExtension('WEBGL_debug_renderer_info');
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  return /swiftshader|llvmpipe|softpipe|software/i.test(name);
}

let webgl = false;

/** True where WebGL 2 can be had. Found out once, as a browser gives few contexts at a time. */
export function hasWebgl(): boolean {
  if (!webgl) {
    try {
      const gl = document.createElement('canvas').getContext('webgl2');
      webgl = gl !== null;
      gl?.getExtension('WEBGL_lose_context')?.loseContext();
    } catch {
      webgl = false;
    }
  }
  return webgl;
}

export class ModelView {
  readonly canvas: HTMLCanvasElement;
  private readonly options: ModelOptions;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly depthScene = new Scene();
  private readonly whoScene = new Scene();
  private readonly screenScene = new Scene();
  private readonly camera = new PerspectiveCamera(kFieldOfView_deg, 1, 1, 10_000);
  private readonly flatCamera = new OrthographicCamera(-1, 1, 1, -1, 0, 1);
  private readonly lamp = new OrthographicCamera(-1, 1, 1, -1, 0.1, 10);
  private readonly controls: OrbitControls;
  private readonly geometry = new BufferGeometry();
  private readonly ghostGeometry = new BufferGeometry();
  private readonly mesh: Mesh<BufferGeometry, RawShaderMaterial[]>;
  /** Without lines, for triangles that are too small for them, and with. */
  private readonly papers: { plain: RawShaderMaterial[]; shadows: RawShaderMaterial[] };
  private readonly inks: Record<string, { value: unknown }>;
  private readonly depthMesh: Mesh;
  private readonly whoMesh: Mesh;
  private readonly ghost: Mesh;
  private readonly table: Mesh;
  private readonly copy: RawShaderMaterial;
  private readonly sunTarget: WebGLRenderTarget;
  private readonly skyTarget: WebGLRenderTarget;
  private readonly whoTarget: WebGLRenderTarget;
  private frameTarget: WebGLRenderTarget | null = null;
  private sumTarget: WebGLRenderTarget | null = null;
  private readonly shared: Record<string, { value: unknown }>;
  private readonly sun = new Vector3(0.5, -0.52, 0.88).normalize();
  private readonly observer: ResizeObserver;
  private lattice: Lattice | null = null;
  /** The lattice with its triangles in the order in which they are drawn. */
  private drawn: Lattice | null = null;
  private order: DrawOrder | null = null;
  private largest_mm: number[] = [];
  private scale: Scale | null = null;
  private colouring: Colouring = 'paper';
  private psi = Math.PI / 2;
  private wantedPsi = Math.PI / 2;   // what does not move lies flat, whatever is wanted
  private ghostOn = false;
  private requested = 0;
  private gathered = 0;
  private changed = true;
  private blendFrom = 0;
  private follow = true;
  private lost = false;
  private slow = false;
  private gatherFrom = 0;
  private litOnce = false;
  private radius = 100;
  private hoverAt: { x: number; y: number } | null = null;
  private hovered: number | null = null;
  private picking = false;
  private left = false;
  private disposed = false;
  private pressed: { x: number; y: number } | null = null;
  private still = false;
  private rest: ReturnType<typeof setTimeout> | undefined;
  private drawing: WebGLSync | null = null;
  private watched = 0;
  private busy = false;
  private coarse = false;
  /** How long the last picture with all its pixels took, ms. */
  private took_ms = 0;
  private filmed = false;
  private drawnAt = -Infinity;
  private width = 1;
  private height = 1;

  constructor(canvas: HTMLCanvasElement, options: ModelOptions = {}) {
    this.canvas = canvas;
    this.options = options;
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: false, powerPreference: 'high-performance' });
    this.renderer.autoClear = false;
    this.slow = drawnBySoftware(this.renderer.getContext());
    this.camera.up.set(0, 0, 1);
    this.camera.position.set(300, -150, 220);
    this.sunTarget = shadowTarget();
    this.skyTarget = shadowTarget();
    this.whoTarget = new WebGLRenderTarget(1, 1, { type: UnsignedByteType, format: RGBAFormat, magFilter: NearestFilter, minFilter: NearestFilter });

    this.shared = {
      pose: { value: new Vector4(0, 1, Math.SQRT1_2, Math.SQRT1_2) },
      blend: { value: 1 },
      sunMatrix: { value: new Matrix4() },
      skyMatrix: { value: new Matrix4() },
      sunMap: { value: this.sunTarget.depthTexture },
      skyMap: { value: this.skyTarget.depthTexture },
      sun: { value: this.sun.clone() },
      sky: { value: new Vector3(0, 0, 1) },
      gathering: { value: 0 },
      eye: { value: new Vector3() },
      accent: { value: new Vector3(0.15, 0.42, 0.7) },
      frames: { value: null },
      frameFirst: { value: 0 },
      frameNext: { value: 0 },
      frameWidth: { value: 1 },
      frameShare: { value: 0 },
    };
    this.inks = {
      ...this.shared,
      back: { value: new Vector3() },
      inkCut: { value: new Vector3() },
      inkMountain: { value: new Vector3() },
      inkValley: { value: new Vector3() },
      dash: { value: 4 },
      ratio: { value: 1 },
      dim: { value: 0 },
      marked: { value: new Vector4(-9, -9, -9, 0) },
    };
    const paper = (defines: Record<string, number>): RawShaderMaterial => new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: paperVertexShader, fragmentShader: paperFragmentShader, side: DoubleSide,
      uniforms: this.inks, defines,
    });
    this.papers = {
      plain: [paper({}), paper({ LINES: 1 })],
      shadows: [paper({ SHADOWS: 1 }), paper({ LINES: 1, SHADOWS: 1 })],
    };
    const deep = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: modelVertexShader, fragmentShader: depthFragmentShader, side: DoubleSide, uniforms: this.shared });
    const who = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: whoVertexShader, fragmentShader: whoFragmentShader, side: DoubleSide, uniforms: this.shared, blending: NoBlending });
    this.mesh = new Mesh(this.geometry, this.papers.shadows);
    this.depthMesh = new Mesh(this.geometry, deep);
    this.whoMesh = new Mesh(this.geometry, who);
    const ghost = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: ghostVertexShader,
      fragmentShader: ghostFragmentShader,
      side: DoubleSide,
      transparent: true,
      depthWrite: false,
      uniforms: { ...this.shared, strength: { value: 0 } },
    });
    this.ghost = new Mesh(this.ghostGeometry, ghost);
    this.ghost.visible = false;
    const table = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: tableVertexShader,
      fragmentShader: tableFragmentShader,
      side: FrontSide,
      uniforms: { ...this.shared, ground: { value: new Vector3() }, dark: { value: 1 } },
    });
    this.table = new Mesh(disc(), table);
    this.table.renderOrder = -1;
    for (const each of [this.mesh, this.depthMesh, this.whoMesh, this.ghost, this.table]) each.frustumCulled = false;
    this.scene.add(this.table, this.mesh, this.ghost);
    this.depthScene.add(this.depthMesh);
    this.whoScene.add(this.whoMesh);
    this.copy = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: screenVertexShader,
      fragmentShader: copyFragmentShader,
      depthTest: false,
      depthWrite: false,
      transparent: true,
      blending: CustomBlending,
      blendEquation: AddEquation,
      blendSrc: SrcAlphaFactor,
      blendDst: OneMinusSrcAlphaFactor,
      uniforms: { from: { value: null }, opacity: { value: 1 } },
    });
    const screen = new Mesh(screenTriangle(), this.copy);
    screen.frustumCulled = false;
    this.screenScene.add(screen);

    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.minPolarAngle = 0.02;
    this.controls.maxPolarAngle = Math.PI - 0.02;
    this.controls.addEventListener('change', () => this.moved());
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(canvas);
    canvas.addEventListener('webglcontextlost', this.onContextLost);
    canvas.addEventListener('webglcontextrestored', this.onContextRestored);
    canvas.addEventListener('pointermove', this.onPointerMove);
    canvas.addEventListener('pointerleave', this.onPointerLeave);
    canvas.addEventListener('pointerdown', this.onPointerDown);
    canvas.addEventListener('pointerup', this.onPointerUp);
    this.retheme();
    this.resize();
  }

  /** Reads the theme's colours again. */
  retheme(): void {
    const style = getComputedStyle(this.canvas);
    const u = this.inks;
    const set = (name: string, variable: string, fallback: Rgb): void => {
      (u[name] as { value: Vector3 }).value.copy(readColour(style, variable, fallback));
    };
    this.frontRgb = readColour(style, '--model-paper', [0.985, 0.975, 0.95]).toArray();
    this.amberRgb = readColour(style, '--model-amber', [0.93, 0.66, 0.16]).toArray();
    this.recolour();
    set('back', '--model-back', [0.8, 0.83, 0.85]);
    set('inkCut', '--model-cut', [0.16, 0.15, 0.14]);
    set('inkMountain', '--model-mountain', [0.72, 0.2, 0.16]);
    set('inkValley', '--model-valley', [0.13, 0.36, 0.64]);
    set('accent', '--model-accent', [0.12, 0.42, 0.72]);
    const ground = readColour(style, '--stage', [0.91, 0.9, 0.875]);
    ((this.table.material as RawShaderMaterial).uniforms['ground'] as { value: Vector3 }).value.copy(ground);
    this.scene.background = null;
    const clear = (Math.round(ground.x * 255) << 16) | (Math.round(ground.y * 255) << 8) | Math.round(ground.z * 255);
    this.clear = clear;
    this.request();
  }
  private clear = 0xe8e6df;
  private frontRgb: Rgb = [1, 1, 1];
  private amberRgb: Rgb = [1, 1, 1];

  /** Where the card lies on the table, and whose faces the scalars colour. */
  setLattice(lattice: Lattice | null, { fit = true, blend = false } = {}): void {
    const old = this.lattice;
    this.lattice = lattice;
    if (!lattice) {
      this.mesh.visible = false;
      this.request();
      return;
    }
    this.mesh.visible = true;
    const before = this.geometry.getAttribute('position') as BufferAttribute | undefined;
    const same = old !== null && before !== undefined && sameTopology(old, lattice);
    const held = same && blend && !this.still ? new BufferAttribute((before as BufferAttribute).array, 3) : null;
    if (!same || !this.order) this.order = drawOrder(lattice);
    this.drawn = ordered(lattice, this.order);
    this.fill(this.drawn, this.order);
    if (held) {
      this.geometry.setAttribute('before', held);
      this.blendFrom = performance.now();
      (this.shared['blend'] as { value: number }).value = 0;
    } else {
      this.geometry.setAttribute('before', this.geometry.getAttribute('position'));
      (this.shared['blend'] as { value: number }).value = 1;
      this.blendFrom = 0;
    }
    this.fillGhost(lattice);
    this.recolour();
    this.psi = lattice.motion === 'flat' ? Math.PI : this.wantedPsi;
    this.pose();
    if (fit) this.fit(false);
    this.request();
  }

  private fill(lattice: Lattice, order: DrawOrder): void {
    const { position, height, along, size, face, kinds } = cornersOf(lattice);
    const g = this.geometry;
    g.dispose();
    g.setAttribute('position', new BufferAttribute(position, 3));
    g.setAttribute('height', new BufferAttribute(height, 1));
    g.setAttribute('along', new BufferAttribute(along, 3));
    g.setAttribute('size', new BufferAttribute(size, 1));
    g.setAttribute('face', new BufferAttribute(face, 1));
    g.setAttribute('kinds', new BufferAttribute(kinds, 4));
    g.setAttribute('tint', new BufferAttribute(new Uint8Array(4 * face.length), 4, true));
    this.largest_mm = largestUpTo(order, size);
    this.fillTips(lattice);
    this.fillFrames(lattice);
    g.setDrawRange(0, face.length);
  }

  /** Draws triangles without lines where no line could be seen in a picture with `mm` per pixel. */
  private leaveOutLines(mm: number): void {
    const all = 3 * (this.drawn?.triangle_face.length ?? 0);
    let faint = 0;
    this.order?.ends.forEach((end, step) => {
      if ((this.largest_mm[step] as number) < kFaint_px * mm) faint = 3 * end;
    });
    const g = this.geometry;
    if (g.groups.length > 0 && g.groups[0]?.count === faint && g.groups[1]?.count === all - faint) return;
    g.clearGroups();
    g.addGroup(0, faint, 0);
    g.addGroup(faint, all - faint, 1);
  }

  private fillTips(lattice: Lattice): void {
    const has = lattice.tips.length > 0 && lattice.motion === 'pose';
    if (has) {
      const n = lattice.triangles.length;
      const apex = new Float32Array(4 * n);
      const alpha = new Float32Array(n);
      const tipOf = new Map<number, number>();
      lattice.tips.forEach((point, t) => tipOf.set(point, t));
      for (let i = 0; i < n; i++) {
        const t = tipOf.get(lattice.triangles[i] as number);
        if (t === undefined) continue;
        apex.set(lattice.tip_apex.subarray(3 * t, 3 * t + 3), 4 * i);
        apex[4 * i + 3] = lattice.tip_w[t] as number;
        alpha[i] = lattice.tip_alpha[t] as number;
      }
      this.geometry.setAttribute('apex', new BufferAttribute(apex, 4));
      this.geometry.setAttribute('alpha', new BufferAttribute(alpha, 1));
    } else {
      this.geometry.deleteAttribute('apex');
      this.geometry.deleteAttribute('alpha');
    }
    this.define('TIPS', has);
  }

  private fillFrames(lattice: Lattice): void {
    const has = lattice.motion === 'frames';
    const held = this.shared['frames'] as { value: DataTexture | null };
    held.value?.dispose();
    held.value = null;
    if (has) {
      const texels = lattice.frames.length / 3;
      const width = 2048;
      const height = Math.ceil(texels / width);
      const data = new Float32Array(4 * width * height);
      for (let i = 0; i < texels; i++) data.set(lattice.frames.subarray(3 * i, 3 * i + 3), 4 * i);
      const texture = new DataTexture(data, width, height, RGBAFormat, FloatType);
      texture.needsUpdate = true;
      held.value = texture;
      (this.shared['frameWidth'] as { value: number }).value = width;
      this.geometry.setAttribute('point', new BufferAttribute(Float32Array.from(lattice.triangles), 1));
    } else {
      this.geometry.deleteAttribute('point');
    }
    this.define('FRAMES', has);
  }

  private define(name: string, on: boolean): void {
    const others = [this.depthMesh, this.whoMesh].map((mesh) => mesh.material as RawShaderMaterial);
    for (const material of [...this.papers.plain, ...this.papers.shadows, ...others]) {
      if ((name in material.defines) === on) continue;
      if (on) material.defines[name] = 1;
      else delete material.defines[name];
      material.needsUpdate = true;
    }
  }

  private fillGhost(lattice: Lattice): void {
    this.ghostGeometry.dispose();
    const { ghost_points, ghost_triangles } = lattice;
    const position = new Float32Array(3 * ghost_triangles.length);
    for (let i = 0; i < ghost_triangles.length; i++) {
      const p = 3 * (ghost_triangles[i] as number);
      position.set(ghost_points.subarray(p, p + 3), 3 * i);
    }
    this.ghostGeometry.setAttribute('position', new BufferAttribute(position, 3));
    this.ghostGeometry.setDrawRange(0, ghost_triangles.length);
  }

  setPsi(psi_rad: number): void {
    this.wantedPsi = psi_rad;
    if (this.lattice?.motion === 'flat' || psi_rad === this.psi) return;
    this.psi = psi_rad;
    this.pose();
    if (this.follow) this.fit(false);
    this.request();
  }

  private pose(): void {
    const { psi } = this;
    (this.shared['pose'] as { value: Vector4 }).value.set(Math.cos(psi), Math.sin(psi), Math.cos(psi / 2), Math.sin(psi / 2));
    const lattice = this.lattice;
    if (!lattice) return;
    const ghost = this.ghost.material as RawShaderMaterial;
    const away = Math.abs(this.psi - lattice.design_psi_rad);
    const strength = this.ghostOn && lattice.ghost_triangles.length > 0 ? Math.max(0, 1 - away / 0.35) : 0;
    (ghost.uniforms['strength'] as { value: number }).value = strength;
    this.ghost.visible = strength > 0;
    if (lattice.motion === 'frames') {
      const n = lattice.points.length / 3;
      const { index, share } = frameAt(lattice.frame_psi, this.psi);
      (this.shared['frameFirst'] as { value: number }).value = index * n;
      (this.shared['frameNext'] as { value: number }).value = Math.min(index + 1, lattice.frame_psi.length - 1) * n;
      (this.shared['frameShare'] as { value: number }).value = share;
    }
  }

  setColouring(colouring: Colouring): void {
    this.colouring = colouring;
    this.recolour();
    this.request();
  }

  private recolour(): void {
    const lattice = this.drawn;
    if (!lattice) return;
    this.scale = scaleOf(lattice, this.colouring);
    const tint = this.geometry.getAttribute('tint') as BufferAttribute;
    tintCorners(lattice, this.scale, this.frontRgb, this.amberRgb, tint.array as Uint8Array);
    tint.needsUpdate = true;
  }

  setGhost(on: boolean): void {
    this.ghostOn = on;
    this.pose();
    this.request();
  }

  /** Greys the model: it is not what the spec says now. */
  setDim(dim: boolean): void {
    (this.inks['dim'] as { value: number }).value = dim ? 1 : 0;
    this.request();
  }

  /** No blends: the person asked for reduced motion. */
  setStill(still: boolean): void {
    this.still = still;
  }

  light(lit: Lit | null): void {
    const marked = (this.inks['marked'] as { value: Vector4 }).value;
    const next = new Vector4(lit?.face ?? -9, lit?.slice ?? -9, lit?.level ?? -9, lit ? 1 : 0);
    if (marked.equals(next)) return;
    marked.copy(next);
    this.request();
  }

  /** Lights any set of faces, beside what `light` does. */
  markFaces(faces: ReadonlySet<number>): void {
    const kinds = this.geometry.getAttribute('kinds') as BufferAttribute | undefined;
    const face = this.geometry.getAttribute('face') as BufferAttribute | undefined;
    if (!kinds || !face) return;
    light({ kinds: kinds.array as Uint16Array, face: face.array as Float32Array }, faces);
    kinds.needsUpdate = true;
    this.request();
  }

  /** Points that are outermost in some pose: enough for the box of all. */
  private outermost(lattice: Lattice): Lattice {
    if (this.outer?.of === lattice) return this.outer.points;
    const { points } = lattice;
    const n = points.length / 3;
    const best = new Set<number>(lattice.tips);
    const kDirections = 24;
    const most = new Float64Array(kDirections + 2).fill(-Infinity);
    const who = new Int32Array(kDirections + 2);
    const ways = Array.from({ length: kDirections }, (_, k) => [Math.cos((2 * Math.PI * k) / kDirections), Math.sin((2 * Math.PI * k) / kDirections)]);
    for (let i = 0; i < n; i++) {
      const x = points[3 * i] as number;
      const z = points[3 * i + 1] as number;
      const v = points[3 * i + 2] as number;
      for (let k = 0; k < kDirections + 2; k++) {
        const way = ways[k];
        const far = way ? x * (way[0] as number) + z * (way[1] as number) : k === kDirections ? v : -v;
        if (far > (most[k] as number)) {
          most[k] = far;
          who[k] = i;
        }
      }
    }
    if (n > 0) for (const i of who) best.add(i);
    const few = new Float32Array(3 * best.size);
    [...best].forEach((i, k) => few.set(points.subarray(3 * i, 3 * i + 3), 3 * k));
    const tips = Uint32Array.from(lattice.tips, (_, k) => k);
    this.outer = { of: lattice, points: lattice.motion === 'pose' ? { ...lattice, points: few, tips } : lattice };
    return this.outer.points;
  }
  private outer: { of: Lattice; points: Lattice } | null = null;

  /** The box of the card in the pose shown, in world mm. */
  private box(): { min: Vector3; max: Vector3 } {
    const lattice = this.lattice;
    const min = new Vector3(Infinity, Infinity, Infinity);
    const max = new Vector3(-Infinity, -Infinity, -Infinity);
    if (lattice) {
      const places = posedPoints(this.outermost(lattice), this.psi);
      for (let i = 0; i < places.length; i += 3) {
        min.x = Math.min(min.x, places[i] as number);
        max.x = Math.max(max.x, places[i] as number);
        min.y = Math.min(min.y, places[i + 1] as number);
        max.y = Math.max(max.y, places[i + 1] as number);
        min.z = Math.min(min.z, places[i + 2] as number);
        max.z = Math.max(max.z, places[i + 2] as number);
      }
    }
    if (!(min.x <= max.x)) {
      min.set(-50, -50, 0);
      max.set(50, 50, 50);
    }
    return { min, max };
  }

  /** Brings the whole card into the picture, from the same side; `reset` also turns it to the usual side. */
  fit(reset: boolean): void {
    const { min, max } = this.box();
    const centre = min.clone().add(max).multiplyScalar(0.5);
    const lattice = this.lattice;
    this.radius = Math.max(1, max.distanceTo(min) / 2, lattice ? lattice.card.wall_mm : 0, lattice ? lattice.card.ground_mm : 0);
    const away = reset || !this.fitted
      ? new Vector3(0.80, -0.50, 0.56)
      : this.camera.position.clone().sub(this.controls.target);
    this.fitted = true;
    away.normalize();
    const side = new Vector3().crossVectors(new Vector3(0, 0, 1), away).normalize();
    const up = new Vector3().crossVectors(away, side);
    const tall = Math.tan((this.camera.fov * Math.PI) / 360);
    const wide = tall * this.camera.aspect;
    let distance = 0;
    for (let i = 0; i < 8; i++) {
      const p = new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z).sub(centre);
      const near = p.dot(away);
      distance = Math.max(distance, near + Math.abs(p.dot(side)) / wide, near + Math.abs(p.dot(up)) / tall);
    }
    distance *= 1.14;
    this.ours = true;
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(away, distance);
    this.camera.near = Math.max(0.5, distance - 3 * this.radius);
    this.camera.far = distance + 30 * this.radius;
    this.camera.updateProjectionMatrix();
    this.controls.minDistance = this.radius * 0.15;
    this.controls.maxDistance = this.radius * 20;
    this.controls.update();
    this.ours = false;
    this.heldDistance = distance;
    this.heldTarget.copy(centre);
    this.follow = true;
    this.table.scale.setScalar(this.radius * 6);
    this.table.position.set(centre.x, centre.y, -0.35);
    this.request();
  }
  /** Shows the whole card from in front, on its right (where v grows) or on its left. */
  lookFrom(side: 'right' | 'left'): void {
    this.camera.position.copy(this.controls.target).add(new Vector3(0.80, side === 'right' ? 0.50 : -0.50, 0.56));
    this.fitted = true;
    this.fit(false);
  }
  private fitted = false;
  private ours = false;
  private heldDistance = 0;
  private readonly heldTarget = new Vector3();

  /** Turns the view by angles in rad (keyboard). */
  turn(around: number, over: number): void {
    const away = this.camera.position.clone().sub(this.controls.target);
    const distance = away.length();
    const azimuth = Math.atan2(away.y, away.x) + around;
    const height = Math.min(1.54, Math.max(-1.54, Math.asin(away.z / distance) + over));
    this.camera.position.copy(this.controls.target).add(
      new Vector3(Math.cos(height) * Math.cos(azimuth), Math.cos(height) * Math.sin(azimuth), Math.sin(height)).multiplyScalar(distance),
    );
    this.controls.update();
    this.moved();
  }

  zoom(factor: number): void {
    const away = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(away);
    this.controls.update();
    this.moved();
  }

  /** While a handle is dragged, the view must not turn. */
  setTurning(on: boolean): void {
    this.controls.enabled = on;
  }

  private moved(): void {
    if (!this.ours) {
      const distance = this.camera.position.distanceTo(this.controls.target);
      if (Math.abs(distance - this.heldDistance) > 0.01 * this.heldDistance) this.follow = false;
      if (this.controls.target.distanceTo(this.heldTarget) > 0.01 * this.radius) this.follow = false;
      this.camera.near = Math.max(0.5, distance - 3 * this.radius);
      this.camera.far = distance + 30 * this.radius;
      this.camera.updateProjectionMatrix();
    }
    this.request();
  }

  private resize(): void {
    this.width = Math.max(1, this.canvas.clientWidth);
    this.height = Math.max(1, this.canvas.clientHeight);
    const { width, height } = this;
    this.renderer.setPixelRatio(this.pixelRatio());
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.frameTarget?.dispose();
    this.sumTarget?.dispose();
    this.frameTarget = this.sumTarget = null;
    if (this.follow && this.lattice) this.fit(false);
    this.request();
  }

  private pixelRatio(): number {
    return Math.min(2, window.devicePixelRatio || 1) * (this.coarse ? 0.5 : 1);
  }

  /** Where pictures take long, what moves is drawn with half the pixels a side: sharp again once it rests. */
  private setCoarse(coarse: boolean): void {
    if (coarse === this.coarse) return;
    this.coarse = coarse;
    this.renderer.setPixelRatio(this.pixelRatio());
  }

  /** Asks for a picture at the next frame of the screen. */
  request(): void {
    this.changed = true;
    clearTimeout(this.rest);
    this.rest = undefined;
    this.schedule();
  }

  private schedule(): void {
    if (this.requested === 0 && !this.lost) this.requested = requestAnimationFrame(this.tick);
  }

  private readonly tick = (): void => {
    this.requested = 0;
    if (this.lost) return;
    // What is drawn off the screen is not held back by it: a queue of frames would make all that follows late.
    if (this.isDrawing()) {
      this.schedule();
      return;
    }
    if (this.hoverAt) void this.hover();
    if (this.changed) {
      this.changed = false;
      this.gathered = 0;
      const now = performance.now();
      const goesOn = this.busy || now - this.drawnAt < kRest_ms;
      this.setCoarse(goesOn && !this.filmed && (this.coarse || this.took_ms > kSmooth_ms));
      this.drawnAt = now;
      this.drawNow();
      this.fence();
      this.options.onDraw?.();
      if (this.blendFrom > 0) this.request();
      else this.settleSoon();
      return;
    }
    if (this.rest === undefined && !this.busy && this.gathered < this.framesToGather()) {
      const now = performance.now();
      if (this.gathered === 1) this.gatherFrom = now;
      if (this.gathered === 4) this.slow ||= (now - this.gatherFrom) / 3 > kSlow_ms;
      this.gather();
      this.fence();
      this.schedule();
    }
  };

  private settleSoon(): void {
    clearTimeout(this.rest);
    this.rest = undefined;
    if (!this.busy && (this.coarse || this.framesToGather() > 0)) this.rest = setTimeout(this.settle, kRest_ms);
  }

  /** While it is filmed, all that is drawn is sharp. */
  setFilmed(filmed: boolean): void {
    this.filmed = filmed;
    this.request();
  }

  /** While a new lattice is on its way, nothing is gathered that it would throw away. */
  setBusy(busy: boolean): void {
    if (busy === this.busy) return;
    this.busy = busy;
    if (this.gathered === 0) this.settleSoon();
    else if (!busy) this.schedule();
  }

  private readonly settle = (): void => {
    this.rest = undefined;
    if (this.coarse && !this.lost) {
      this.setCoarse(false);
      this.drawnAt = performance.now();
      this.drawNow();
      this.fence();
    }
    this.schedule();
  };

  private fence(): void {
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (this.drawing) gl.deleteSync(this.drawing);
    this.drawing = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    if (this.watched === 0) this.watched = requestAnimationFrame(this.watch);
  }

  /** Looks at each frame of the screen whether the GPU is done, so that how long it took is known. */
  private readonly watch = (): void => {
    this.watched = this.isDrawing() && !this.lost && !this.disposed ? requestAnimationFrame(this.watch) : 0;
  };

  /** True until the GPU has drawn what it was given last. */
  private isDrawing(): boolean {
    if (!this.drawing) return false;
    const gl = this.renderer.getContext() as WebGL2RenderingContext;
    if (gl.getSyncParameter(this.drawing, gl.SYNC_STATUS) !== gl.SIGNALED) return true;
    gl.deleteSync(this.drawing);
    this.drawing = null;
    if (!this.coarse && this.gathered === 0) this.took_ms = performance.now() - this.drawnAt;
    return false;
  }

  private framesToGather(): number {
    const triangles = this.lattice ? this.lattice.triangle_face.length : 0;
    if (triangles === 0 || triangles > kMostGatheredTriangles) return 0;
    return this.slow ? kGatheredSlow : kGathered;
  }

  /** Draws now, without waiting for the screen: for pictures and for measurements. */
  drawNow(): void {
    if (this.blendFrom > 0) {
      const share = Math.min(1, (performance.now() - this.blendFrom) / 120);
      (this.shared['blend'] as { value: number }).value = share * share * (3 - 2 * share);
      if (share >= 1) this.blendFrom = 0;
    }
    (this.shared['gathering'] as { value: number }).value = 0;
    // A slow machine has no shadows while something moves.
    const plain = this.slow && this.litOnce;
    this.shadow(!plain);
    if (!plain) this.shine(this.sun, this.sunTarget, 'sunMatrix');
    if (!this.litOnce) this.shine(this.sun, this.skyTarget, 'skyMatrix');
    this.litOnce = true;
    (this.shared['sun'] as { value: Vector3 }).value.copy(this.sun);
    this.camera.clearViewOffset();
    this.drawScene(null);
  }

  /** With shadows or without: then the table has none either, and is as grey as what is around it. */
  private shadow(on: boolean): void {
    this.mesh.material = on ? this.papers.shadows : this.papers.plain;
    this.table.visible = on;
  }

  private drawScene(target: WebGLRenderTarget | null): void {
    const u = this.inks;
    (this.shared['eye'] as { value: Vector3 }).value.copy(this.camera.position);
    const ratio = this.renderer.getPixelRatio();
    const pixels = this.renderer.domElement.height;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const mm = (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360)) / pixels;
    (u['dash'] as { value: number }).value = 2 ** Math.round(Math.log2(16 * ratio * mm));
    (u['ratio'] as { value: number }).value = ratio;
    this.leaveOutLines(mm * Math.max(0.05, 1 - this.radius / distance));
    this.renderer.setRenderTarget(target);
    this.renderer.setClearColor(this.clear, 1);
    this.renderer.clear(true, true, false);
    this.renderer.render(this.scene, this.camera);
    this.renderer.setRenderTarget(null);
  }

  /** The depth seen from the direction of a light. */
  private shine(direction: Vector3, target: WebGLRenderTarget, matrix: 'sunMatrix' | 'skyMatrix'): void {
    const { controls, lamp } = this;
    const r = this.radius * 1.35;
    const centre = this.follow ? this.heldTarget : controls.target;
    const middle = this.lattice ? this.heldTarget : centre;
    lamp.left = lamp.bottom = -r;
    lamp.right = lamp.top = r;
    lamp.near = 0.1;
    lamp.far = 4 * r;
    lamp.up.set(0, 0, 1);
    if (Math.abs(direction.z) > 0.98) lamp.up.set(1, 0, 0);
    lamp.position.copy(middle).addScaledVector(direction, 2 * r);
    lamp.lookAt(middle);
    lamp.updateMatrixWorld();
    lamp.updateProjectionMatrix();
    (this.shared[matrix] as { value: Matrix4 }).value.multiplyMatrices(lamp.projectionMatrix, lamp.matrixWorldInverse);
    this.renderer.setRenderTarget(target);
    this.renderer.clear(true, true, false);
    this.renderer.render(this.depthScene, lamp);
    this.renderer.setRenderTarget(null);
  }

  /** One more frame with moved lights and a moved eye, added to the mean of those before. */
  private gather(): void {
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    this.frameTarget ??= new WebGLRenderTarget(size.x, size.y, { magFilter: NearestFilter, minFilter: NearestFilter });
    this.sumTarget ??= new WebGLRenderTarget(size.x, size.y, { type: HalfFloatType, depthBuffer: false, magFilter: NearestFilter, minFilter: NearestFilter });
    const i = this.gathered + 1;
    const turn = 2 * Math.PI * halton(i, 2);
    const out = 0.10 * Math.sqrt(halton(i, 3));
    const sun = this.sun.clone();
    const a = new Vector3(-sun.y, sun.x, 0).normalize();
    const b = new Vector3().crossVectors(sun, a);
    sun.addScaledVector(a, out * Math.cos(turn)).addScaledVector(b, out * Math.sin(turn)).normalize();
    const up = 0.1 + 0.9 * halton(i, 5);
    const round = 2 * Math.PI * halton(i, 7);
    const flat = Math.sqrt(1 - up * up);
    const sky = new Vector3(flat * Math.cos(round), flat * Math.sin(round), up);
    this.shadow(true);
    this.shine(sun, this.sunTarget, 'sunMatrix');
    this.shine(sky, this.skyTarget, 'skyMatrix');
    (this.shared['sun'] as { value: Vector3 }).value.copy(sun);
    (this.shared['sky'] as { value: Vector3 }).value.copy(sky);
    (this.shared['gathering'] as { value: number }).value = 1;
    this.camera.setViewOffset(size.x, size.y, halton(i, 11) - 0.5, halton(i, 13) - 0.5, size.x, size.y);
    this.drawScene(this.frameTarget);
    this.camera.clearViewOffset();
    this.blit(this.frameTarget, this.sumTarget, 1 / i);
    this.gathered = i;
    // The first few are too rough to show.
    if (i >= 12 || i === this.framesToGather()) this.blit(this.sumTarget, null, 1);
  }

  private blit(from: WebGLRenderTarget, to: WebGLRenderTarget | null, opacity: number): void {
    (this.copy.uniforms['from'] as { value: unknown }).value = from.texture;
    (this.copy.uniforms['opacity'] as { value: number }).value = opacity;
    this.renderer.setRenderTarget(to);
    this.renderer.render(this.screenScene, this.flatCamera);
    this.renderer.setRenderTarget(null);
  }

  /**
   * The face at a place of the canvas in CSS pixels, or null: one pixel is drawn, with numbers for colours. It is read
   * once the GPU has it, so that nothing waits.
   */
  async pick(x: number, y: number): Promise<number | null> {
    if (this.lost || !this.lattice) return null;
    const { width, height } = this;
    if (x < 0 || y < 0 || x >= width || y >= height) return null;
    this.camera.setViewOffset(width, height, x, y, 1, 1);
    this.renderer.setRenderTarget(this.whoTarget);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear(true, true, false);
    this.renderer.render(this.whoScene, this.camera);
    const pixel = new Uint8Array(4);
    const read = this.renderer.readRenderTargetPixelsAsync(this.whoTarget, 0, 0, 1, 1, pixel);
    this.renderer.setRenderTarget(null);
    this.camera.clearViewOffset();
    await read;
    const id = (pixel[0] as number) + 256 * (pixel[1] as number) + 65536 * (pixel[2] as number);
    return id === 0 ? null : id - 1;
  }

  /** Where a place in the world (mm) lies on the canvas, in CSS pixels. */
  project(X: number, V: number, Z: number): { x: number; y: number; behind: boolean } {
    this.camera.updateMatrixWorld();
    const p = new Vector3(X, V, Z).project(this.camera);
    return {
      x: (p.x * 0.5 + 0.5) * this.width,
      y: (0.5 - p.y * 0.5) * this.height,
      behind: p.z > 1 || p.z < -1,
    };
  }

  private async hover(): Promise<void> {
    const at = this.hoverAt;
    if (!at || this.picking) return;
    this.hoverAt = null;
    this.picking = true;
    const face = await this.pick(at.x, at.y).catch(() => null);
    this.picking = false;
    if (this.disposed) return;
    if (!this.left && face !== this.hovered) {
      this.hovered = face;
      this.options.onHover?.(face);
    }
    if (this.hoverAt) this.schedule();
  }

  private readonly onPointerMove = (event: PointerEvent): void => {
    if (event.buttons !== 0 || event.pointerType === 'touch') return;
    this.left = false;
    this.hoverAt = { x: event.offsetX, y: event.offsetY };
    this.schedule();
  };

  private readonly onPointerLeave = (): void => {
    this.hoverAt = null;
    this.left = true;
    if (this.hovered !== null) {
      this.hovered = null;
      this.options.onHover?.(null);
    }
  };

  private readonly onPointerDown = (event: PointerEvent): void => {
    this.pressed = { x: event.clientX, y: event.clientY };
  };

  private readonly onPointerUp = (event: PointerEvent): void => {
    const from = this.pressed;
    this.pressed = null;
    if (!from || Math.hypot(event.clientX - from.x, event.clientY - from.y) > 4) return;
    void this.pick(event.offsetX, event.offsetY).then((face) => {
      if (!this.disposed) this.options.onPick?.(face, event);
    }, () => undefined);
  };

  private readonly onContextLost = (event: Event): void => {
    event.preventDefault();
    this.lost = true;
    if (this.requested) cancelAnimationFrame(this.requested);
    this.requested = 0;
    this.options.onLost?.();
  };

  private readonly onContextRestored = (): void => {
    this.lost = false;
    this.drawing = null;
    this.litOnce = false;
    this.frameTarget = this.sumTarget = null;
    this.options.onRestored?.();
    this.request();
  };

  get psi_rad(): number {
    return this.psi;
  }

  get shownScale(): Scale | null {
    return this.scale;
  }

  /** True once the picture rests and nothing more will be drawn. */
  get resting(): boolean {
    return !this.changed && this.requested === 0 && this.rest === undefined;
  }

  /** The picture as PNG, with all that is gathered. */
  png(): Promise<Blob | null> {
    this.setCoarse(false);
    this.drawNow();
    this.gathered = 0;
    const { slow } = this;
    this.slow = false;
    while (this.gathered < this.framesToGather()) this.gather();
    this.slow = slow;
    return new Promise((done) => this.canvas.toBlob(done, 'image/png'));
  }

  /** The pixels of the last picture, as the GPU has them (bottom row first): waits until it is drawn. */
  pixels(): Uint8Array {
    const gl = this.renderer.getContext();
    const out = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);
    this.drawNow();
    gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, out);
    return out;
  }

  /** What the GPU is given of each corner of each triangle, by the names of the vertex shader. */
  corners(): ReadonlyMap<string, { values: Float32Array; size: number }> {
    return new Map(Object.entries(this.geometry.attributes).map(([name, attribute]) => [
      name, { values: (attribute as BufferAttribute).array as Float32Array, size: attribute.itemSize },
    ]));
  }

  /** The direction from what is looked at to the eye. */
  towardsEye(): readonly [number, number, number] {
    const away = this.camera.position.clone().sub(this.controls.target).normalize();
    return [away.x, away.y, away.z];
  }

  dispose(): void {
    this.disposed = true;
    if (this.requested) cancelAnimationFrame(this.requested);
    clearTimeout(this.rest);
    this.observer.disconnect();
    this.controls.dispose();
    const { canvas } = this;
    canvas.removeEventListener('webglcontextlost', this.onContextLost);
    canvas.removeEventListener('webglcontextrestored', this.onContextRestored);
    canvas.removeEventListener('pointermove', this.onPointerMove);
    canvas.removeEventListener('pointerleave', this.onPointerLeave);
    canvas.removeEventListener('pointerdown', this.onPointerDown);
    canvas.removeEventListener('pointerup', this.onPointerUp);
    this.geometry.dispose();
    this.ghostGeometry.dispose();
    for (const material of [...this.papers.plain, ...this.papers.shadows]) material.dispose();
    for (const mesh of [this.depthMesh, this.whoMesh, this.ghost, this.table]) (mesh.material as RawShaderMaterial).dispose();
    for (const target of [this.sunTarget, this.skyTarget, this.whoTarget, this.frameTarget, this.sumTarget]) target?.dispose();
    (this.shared['frames'] as { value: DataTexture | null }).value?.dispose();
    this.renderer.dispose();
    if (!this.renderer.getContext().isContextLost()) this.renderer.forceContextLoss();   // at once, not when the garbage is collected: there are sixteen
  }
}

function shadowTarget(): WebGLRenderTarget {
  const depth = new DepthTexture(kShadowPixels, kShadowPixels);
  depth.compareFunction = LessEqualCompare;
  depth.magFilter = depth.minFilter = LinearFilter;
  return new WebGLRenderTarget(kShadowPixels, kShadowPixels, { depthTexture: depth, magFilter: NearestFilter, minFilter: NearestFilter });
}

function disc(): BufferGeometry {
  const n = 48;
  const corner: number[] = [];
  for (let i = 0; i < n; i++) {
    const a = (2 * Math.PI * i) / n;
    const b = (2 * Math.PI * (i + 1)) / n;
    corner.push(0, 0, 0, Math.cos(a), Math.sin(a), 0, Math.cos(b), Math.sin(b), 0);
  }
  const out = new BufferGeometry();
  out.setAttribute('position', new BufferAttribute(Float32Array.from(corner), 3));
  return out;
}

function screenTriangle(): BufferGeometry {
  const out = new BufferGeometry();
  out.setAttribute('position', new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
  return out;
}

