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
import { cornerValues, scaleOf, stopsOf, type Colouring, type Rgb, type Scale } from './ramps';

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

/** The vertex shader of the model: every place comes from psi. Its output vWorld is in mm. */
export const modelVertexShader = /* glsl */ `
precision highp float;
precision highp int;
in vec3 position;
in vec3 before;
in vec3 across;
in vec3 along;
in vec2 grain;
in vec4 who;
in float value;
#ifdef TIPS
in vec4 apex;
in float alpha;
#endif
#ifdef FRAMES
in float point;
uniform highp sampler2D frames;
uniform int frameFirst, frameNext, frameWidth;
uniform float frameShare;
vec3 framed(int i) {
  return texelFetch(frames, ivec2(i % frameWidth, i / frameWidth), 0).xyz;
}
#endif
uniform mat4 modelViewMatrix, projectionMatrix;
uniform vec4 pose; // cos psi, sin psi, cos psi/2, sin psi/2: the GPU's own are not exact enough
uniform float blend;
uniform mat4 sunMatrix, skyMatrix;
out vec3 vWorld;
out vec3 vAcross;
out vec3 vAlong;
flat out vec2 vGrain;
flat out vec4 vWho;
out float vValue;
out vec3 vSun;
out vec3 vSky;
vec3 opened(vec3 p) {
  return vec3(p.x + p.y * pose.x, p.z, p.y * pose.y);
}
void main() {
#ifdef FRAMES
  vec3 world = mix(framed(frameFirst + int(point)), framed(frameNext + int(point)), frameShare);
#else
  vec3 world = opened(mix(before, position, blend));
#ifdef TIPS
  if (apex.w > 0.0) {
    // Half the splay angle has the tangent t.
    float t = alpha * pose.z;
    float up = apex.w * 2.0 * t / (1.0 + t * t);
    world = opened(apex.xyz) + vec3(up * pose.z, apex.w * (1.0 - t * t) / (1.0 + t * t), up * pose.w);
  }
#endif
#endif
  vWorld = world;
  vAcross = across;
  vAlong = along;
  vGrain = grain;
  vWho = who;
  vValue = value;
  vec4 s = sunMatrix * vec4(world, 1.0);
  vSun = s.xyz * 0.5 + 0.5;
  s = skyMatrix * vec4(world, 1.0);
  vSky = s.xyz * 0.5 + 0.5;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(world, 1.0);
}`;

const kLight = /* glsl */ `
uniform highp sampler2DShadow sunMap, skyMap;
uniform vec3 sun, sky;
uniform float gathering, texel;
float seen(highp sampler2DShadow map, vec3 at, float bias) {
  if (at.x <= 0.0 || at.x >= 1.0 || at.y <= 0.0 || at.y >= 1.0) return 1.0;
  return texture(map, vec3(at.xy, at.z - bias));
}
// Direct light and light of the sky on a surface that faces n, in linear light.
vec3 lit(vec3 n, vec3 atSun, vec3 atSky, float bias) {
  float d = dot(n, sun);
  float s = d > 0.0 ? d * seen(sunMap, atSun, bias) : 0.0;
  float a;
  if (gathering > 0.5) {
    float e = dot(n, sky);
    a = e > 0.0 ? 2.0 * e * seen(skyMap, atSky, bias) : 0.0;
  } else {
    a = 0.88 * (0.5 + 0.5 * n.z);
  }
  float through = d < 0.0 ? -d * 0.10 : 0.0;
  vec3 warm = vec3(1.0, 0.965, 0.90), cool = vec3(0.88, 0.94, 1.0);
  return warm * (0.68 * s + through) + cool * 0.40 * a + vec3(0.17, 0.165, 0.16);
}
vec3 shown(vec3 linear) {
  return pow(clamp(linear, 0.0, 1.0), vec3(1.0 / 2.2));
}
`;

const kPaper = /* glsl */ `
precision highp float;
precision highp int;
in vec3 vWorld;
in vec3 vAcross;
in vec3 vAlong;
flat in vec2 vGrain;
flat in vec4 vWho;
in float vValue;
in vec3 vSun;
in vec3 vSky;
uniform vec3 front, back, inkCut, inkMountain, inkValley, accent, amber;
uniform vec3 stops[5];
uniform int stepped;
uniform float dash, ratio, dim;
uniform vec4 marked; // face, slice, level; w: 1 if any is lit
uniform vec3 eye;
out vec4 colour;
${kLight}
vec3 ramp(float t) {
  float at = clamp(t, 0.0, 1.0) * 4.0;
  int i = int(min(3.0, floor(at)));
  if (stepped == 1) return stops[int(at + 0.5)];
  return mix(stops[i], stops[i + 1], at - float(i));
}
float stroke(float role, float across, float along, float width) {
  float mm = max(fwidth(across), 1e-5);
  float body = 1.0 - smoothstep(width - 0.6, width + 0.6, across / mm);
  float t = fract(along / dash);
  float soft = 0.06;
  float open = 1.0;
  if (role > 1.5 && role < 2.5) {
    open = smoothstep(0.0, soft, t) - smoothstep(0.52, 0.52 + soft, t) + smoothstep(0.70, 0.70 + soft, t) - smoothstep(0.82, 0.82 + soft, t);
  } else if (role > 2.5 && role < 3.5) {
    float h = fract(2.0 * along / dash);
    open = smoothstep(0.0, soft, h) - smoothstep(0.56, 0.56 + soft, h);
  }
  float fade = smoothstep(2.5, 9.0, vGrain.y / mm);
  return body * open * fade;
}
void main() {
  vec3 n = normalize(cross(dFdx(vWorld), dFdy(vWorld)));
  if (dot(n, eye - vWorld) < 0.0) n = -n;
  float slope = 1.0 - abs(dot(n, sun));
  vec3 base = gl_FrontFacing ? front : back;
  float kind = mod(vWho.w, 4.0);
  bool merged = mod(floor(vWho.w / 4.0), 2.0) > 0.5;
  if (gl_FrontFacing) {
    if (vValue >= 0.0) base = ramp(vValue) * (stepped == 1 ? 1.0 : 1.0);
    if (merged && kind < 0.5) base = mix(base, amber, 0.72);
  }
  bool on = vWho.w >= 8.0 || marked.w > 0.5 && kind < 2.5 &&
    (abs(vWho.x - marked.x) < 0.5 || abs(vWho.y - marked.y) < 0.5 || abs(vWho.z - marked.z) < 0.5);
  base = base * base * (base * 0.305306 + 0.682171) + base * 0.012522878;
  if (on) base = mix(base, accent * accent, 0.42);
  vec3 c = base * lit(n, vSun, vSky, 0.0012 + 0.004 * slope);
  c = shown(c);
  float roles = vGrain.x;
  float r0 = mod(roles, 8.0), r1 = mod(floor(roles / 8.0), 8.0), r2 = floor(roles / 64.0);
  vec3 r = vec3(r0, r1, r2);
  for (int k = 0; k < 3; k++) {
    float role = r[k];
    // fwidth must be taken outside of branches that differ between pixels.
    bool cut = (role > 0.5 && role < 1.5) || role > 3.5;
    float a = stroke(role, vAcross[k], vAlong[k], (cut ? 0.62 : 0.78) * ratio);
    if (role < 0.5) a = 0.0;
    vec3 ink = cut ? inkCut : role < 2.5 ? inkMountain : inkValley;
    c = mix(c, ink, a * (cut ? 0.72 : 0.8));
  }
  colour = vec4(mix(c, vec3(dot(c, vec3(0.3333))), dim * 0.8), 1.0);
}`;

const kDepth = /* glsl */ `
precision highp float;
out vec4 colour;
void main() {
  colour = vec4(1.0);
}`;

const kWho = /* glsl */ `
precision highp float;
precision highp int;
flat in vec4 vWho;
out vec4 colour;
void main() {
  int id = int(vWho.x + 0.5) + 1;
  colour = vec4(float(id & 255), float((id >> 8) & 255), float((id >> 16) & 255), 255.0) / 255.0;
}`;

const kTableVertex = /* glsl */ `
precision highp float;
in vec3 position;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix, sunMatrix, skyMatrix;
out vec3 vWorld;
out vec3 vSun;
out vec3 vSky;
out float vOut;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vWorld = world.xyz;
  vOut = length(position.xy);
  vSun = (sunMatrix * world).xyz * 0.5 + 0.5;
  vSky = (skyMatrix * world).xyz * 0.5 + 0.5;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

const kTable = /* glsl */ `
precision highp float;
in vec3 vWorld;
in vec3 vSun;
in vec3 vSky;
in float vOut;
uniform vec3 ground;
uniform float dark;
out vec4 colour;
${kLight}
void main() {
  vec3 n = vec3(0.0, 0.0, 1.0);
  float s = seen(sunMap, vSun, 0.001);
  float a = gathering > 0.5 ? 2.0 * max(0.0, sky.z) * seen(skyMap, vSky, 0.001) : 1.0;
  float full = 0.66 * sun.z + 0.36;
  a = mix(1.0, a, 0.4);
  float light = (0.66 * sun.z * s + 0.36 * a) / full;
  light = mix(1.0, light, (1.0 - smoothstep(0.13, 0.25, vOut)) * dark);
  colour = vec4(ground * pow(max(light, 0.0), 0.5), 1.0);
}`;

const kGhostVertex = /* glsl */ `
precision highp float;
in vec3 position;
uniform mat4 modelViewMatrix, projectionMatrix;
out vec3 vWorld;
void main() {
  vWorld = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

const kGhost = /* glsl */ `
precision highp float;
in vec3 vWorld;
uniform vec3 eye, accent;
uniform float strength;
out vec4 colour;
void main() {
  vec3 n = normalize(cross(dFdx(vWorld), dFdy(vWorld)));
  float facing = abs(dot(n, normalize(eye - vWorld)));
  float rim = pow(1.0 - facing, 2.5);
  colour = vec4(accent, strength * (0.16 + 0.6 * rim));
}`;

const kScreenVertex = /* glsl */ `
precision highp float;
in vec3 position;
out vec2 at;
void main() {
  at = position.xy * 0.5 + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

const kCopy = /* glsl */ `
precision highp float;
in vec2 at;
uniform sampler2D from;
uniform float opacity;
out vec4 colour;
void main() {
  colour = vec4(texture(from, at).rgb, opacity);
}`;

// Colours are given and mixed as they are shown; the shaders do their own light.
ColorManagement.enabled = false;

/** Frames that are gathered once the picture rests; fewer where one takes long. */
const kGathered = 40;
const kGatheredSlow = 14;
const kSlow_ms = 70;
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

/** True where WebGL 2 can be had. */
export function hasWebgl(): boolean {
  try {
    return document.createElement('canvas').getContext('webgl2') !== null;
  } catch {
    return false;
  }
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
  private readonly mesh: Mesh;
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
  private scale: Scale | null = null;
  private colouring: Colouring = 'paper';
  private psi = Math.PI / 2;
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
  private pressed: { x: number; y: number } | null = null;
  private still = false;

  constructor(canvas: HTMLCanvasElement, options: ModelOptions = {}) {
    this.canvas = canvas;
    this.options = options;
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: false, powerPreference: 'high-performance' });
    this.renderer.autoClear = false;
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
      texel: { value: 1 / kShadowPixels },
      eye: { value: new Vector3() },
      accent: { value: new Vector3(0.15, 0.42, 0.7) },
      frames: { value: null },
      frameFirst: { value: 0 },
      frameNext: { value: 0 },
      frameWidth: { value: 1 },
      frameShare: { value: 0 },
    };
    const paper = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: modelVertexShader,
      fragmentShader: kPaper,
      side: DoubleSide,
      uniforms: {
        ...this.shared,
        front: { value: new Vector3() },
        back: { value: new Vector3() },
        inkCut: { value: new Vector3() },
        inkMountain: { value: new Vector3() },
        inkValley: { value: new Vector3() },
        amber: { value: new Vector3() },
        stops: { value: Array.from({ length: 5 }, () => new Vector3(1, 1, 1)) },
        stepped: { value: 0 },
        dash: { value: 4 },
        ratio: { value: 1 },
        dim: { value: 0 },
        marked: { value: new Vector4(-9, -9, -9, 0) },
      },
    });
    const deep = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: modelVertexShader, fragmentShader: kDepth, side: DoubleSide, uniforms: this.shared });
    const who = new RawShaderMaterial({ glslVersion: GLSL3, vertexShader: modelVertexShader, fragmentShader: kWho, side: DoubleSide, uniforms: this.shared, blending: NoBlending });
    this.mesh = new Mesh(this.geometry, paper);
    this.depthMesh = new Mesh(this.geometry, deep);
    this.whoMesh = new Mesh(this.geometry, who);
    const ghost = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kGhostVertex,
      fragmentShader: kGhost,
      side: DoubleSide,
      transparent: true,
      depthWrite: false,
      uniforms: { ...this.shared, strength: { value: 0 } },
    });
    this.ghost = new Mesh(this.ghostGeometry, ghost);
    this.ghost.visible = false;
    const table = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: kTableVertex,
      fragmentShader: kTable,
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
      vertexShader: kScreenVertex,
      fragmentShader: kCopy,
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
    const u = (this.mesh.material as RawShaderMaterial).uniforms;
    const set = (name: string, variable: string, fallback: Rgb): void => {
      (u[name] as { value: Vector3 }).value.copy(readColour(style, variable, fallback));
    };
    set('front', '--model-paper', [0.985, 0.975, 0.95]);
    set('back', '--model-back', [0.8, 0.83, 0.85]);
    set('inkCut', '--model-cut', [0.16, 0.15, 0.14]);
    set('inkMountain', '--model-mountain', [0.72, 0.2, 0.16]);
    set('inkValley', '--model-valley', [0.13, 0.36, 0.64]);
    set('amber', '--model-amber', [0.93, 0.66, 0.16]);
    set('accent', '--model-accent', [0.12, 0.42, 0.72]);
    const ground = readColour(style, '--stage', [0.91, 0.9, 0.875]);
    ((this.table.material as RawShaderMaterial).uniforms['ground'] as { value: Vector3 }).value.copy(ground);
    this.scene.background = null;
    const clear = (Math.round(ground.x * 255) << 16) | (Math.round(ground.y * 255) << 8) | Math.round(ground.z * 255);
    this.clear = clear;
    this.request();
  }
  private clear = 0xe8e6df;

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
    const same = blend && !this.still && old !== null && before !== undefined && sameTopology(old, lattice);
    const held = same ? new BufferAttribute((before as BufferAttribute).array, 3) : null;
    this.fill(lattice);
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
    if (lattice.motion === 'flat') this.psi = Math.PI;
    this.pose();
    if (fit) this.fit(false);
    this.request();
  }

  private fill(lattice: Lattice): void {
    const { points, triangles, triangle_face, sides } = lattice;
    const m = triangle_face.length;
    const position = new Float32Array(9 * m);
    const across = new Float32Array(9 * m);
    const along = new Float32Array(9 * m);
    const grain = new Float32Array(6 * m);
    const who = new Float32Array(12 * m);
    const wall = lattice.card.wall_mm;
    for (let t = 0; t < m; t++) {
      const face = triangle_face[t] as number;
      const i0 = 3 * (triangles[3 * t] as number);
      const i1 = 3 * (triangles[3 * t + 1] as number);
      const i2 = 3 * (triangles[3 * t + 2] as number);
      const corner = [i0, i1, i2];
      const us = [0, 0, 0];
      const vs = [0, 0, 0];
      for (let k = 0; k < 3; k++) {
        const i = corner[k] as number;
        const x = points[i] as number;
        const z = points[i + 1] as number;
        const v = points[i + 2] as number;
        const at = 9 * t + 3 * k;
        position[at] = x;
        position[at + 1] = z;
        position[at + 2] = v;
        us[k] = x + wall - z;
        vs[k] = v;
      }
      const [u0, u1, u2] = us as [number, number, number];
      const [v0, v1, v2] = vs as [number, number, number];
      const twice = Math.abs((u1 - u0) * (v2 - v0) - (v1 - v0) * (u2 - u0));
      const roles = (sides[3 * t] as number) + 8 * (sides[3 * t + 1] as number) + 64 * (sides[3 * t + 2] as number);
      const size = Math.sqrt(twice);
      for (let k = 0; k < 3; k++) {
        const a = k;
        const b = (k + 1) % 3;
        const c = (k + 2) % 3;
        let du = (us[b] as number) - (us[a] as number);
        let dv = (vs[b] as number) - (vs[a] as number);
        const length = Math.hypot(du, dv) || 1e-9;
        if (du < 0 || (du === 0 && dv < 0)) {
          du = -du;
          dv = -dv;
        }
        du /= length;
        dv /= length;
        across[9 * t + 3 * c + k] = twice / length;
        for (const j of [a, b, c]) along[9 * t + 3 * j + k] = (us[j] as number) * du + (vs[j] as number) * dv;
      }
      const flags = (lattice.face_kind[face] as number) + (lattice.face_merged[face] ? 4 : 0);
      for (let k = 0; k < 3; k++) {
        grain[6 * t + 2 * k] = roles;
        grain[6 * t + 2 * k + 1] = size;
        const at = 12 * t + 4 * k;
        who[at] = face;
        who[at + 1] = lattice.face_slice[face] as number;
        who[at + 2] = lattice.face_level[face] as number;
        who[at + 3] = flags;
      }
    }
    const g = this.geometry;
    g.dispose();
    g.setAttribute('position', new BufferAttribute(position, 3));
    g.setAttribute('across', new BufferAttribute(across, 3));
    g.setAttribute('along', new BufferAttribute(along, 3));
    g.setAttribute('grain', new BufferAttribute(grain, 2));
    g.setAttribute('who', new BufferAttribute(who, 4));
    g.setAttribute('value', new BufferAttribute(new Float32Array(3 * m).fill(-1), 1));
    this.fillTips(lattice);
    this.fillFrames(lattice);
    g.setDrawRange(0, 3 * m);
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
    for (const mesh of [this.mesh, this.depthMesh, this.whoMesh]) {
      const material = mesh.material as RawShaderMaterial;
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
    if (this.lattice?.motion === 'flat') return;
    if (psi_rad === this.psi) return;
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
    const lattice = this.lattice;
    if (!lattice) return;
    this.scale = scaleOf(lattice, this.colouring);
    const value = this.geometry.getAttribute('value') as BufferAttribute;
    cornerValues(lattice, this.scale, value.array as Float32Array);
    value.needsUpdate = true;
    const u = (this.mesh.material as RawShaderMaterial).uniforms;
    const held = (u['stops'] as { value: Vector3[] }).value;
    stopsOf(this.scale).forEach((stop, i) => held[i]?.set(stop[0], stop[1], stop[2]));
    (u['stepped'] as { value: number }).value = this.scale.kind === 'names' ? 1 : 0;
  }

  setGhost(on: boolean): void {
    this.ghostOn = on;
    this.pose();
    this.request();
  }

  /** Greys the model: it is not what the spec says now. */
  setDim(dim: boolean): void {
    ((this.mesh.material as RawShaderMaterial).uniforms['dim'] as { value: number }).value = dim ? 1 : 0;
    this.request();
  }

  /** No blends: the person asked for reduced motion. */
  setStill(still: boolean): void {
    this.still = still;
  }

  light(lit: Lit | null): void {
    const marked = ((this.mesh.material as RawShaderMaterial).uniforms['marked'] as { value: Vector4 }).value;
    const next = new Vector4(lit?.face ?? -9, lit?.slice ?? -9, lit?.level ?? -9, lit ? 1 : 0);
    if (marked.equals(next)) return;
    marked.copy(next);
    this.request();
  }

  /** Lights any set of faces, beside what `light` does. */
  markFaces(faces: ReadonlySet<number>): void {
    const who = this.geometry.getAttribute('who') as BufferAttribute | undefined;
    if (!who) return;
    const values = who.array as Float32Array;
    for (let i = 0; i < values.length; i += 4) {
      values[i + 3] = ((values[i + 3] as number) % 8) + (faces.has(values[i] as number) ? 8 : 0);
    }
    who.needsUpdate = true;
    this.request();
  }

  /** The box of the card in the pose shown, in world mm. */
  private box(): { min: Vector3; max: Vector3 } {
    const lattice = this.lattice;
    const min = new Vector3(Infinity, Infinity, Infinity);
    const max = new Vector3(-Infinity, -Infinity, -Infinity);
    if (lattice) {
      const places = posedPoints(lattice, this.psi);
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
    const width = Math.max(1, this.canvas.clientWidth);
    const height = Math.max(1, this.canvas.clientHeight);
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.frameTarget?.dispose();
    this.sumTarget?.dispose();
    this.frameTarget = this.sumTarget = null;
    if (this.follow && this.lattice) this.fit(false);
    this.request();
  }

  /** Asks for a picture at the next frame of the screen. */
  request(): void {
    this.changed = true;
    this.schedule();
  }

  private schedule(): void {
    if (this.requested === 0 && !this.lost) this.requested = requestAnimationFrame(this.tick);
  }

  private readonly tick = (): void => {
    this.requested = 0;
    if (this.lost) return;
    if (this.hoverAt) this.hover();
    if (this.changed) {
      this.changed = false;
      this.gathered = 0;
      this.drawNow();
      this.options.onDraw?.();
      if (this.blendFrom > 0) this.request();
      else this.schedule();
      return;
    }
    if (this.gathered < this.framesToGather()) {
      const now = performance.now();
      if (this.gathered === 1) this.gatherFrom = now;
      if (this.gathered === 4) this.slow = (now - this.gatherFrom) / 3 > kSlow_ms;
      this.gather();
      this.schedule();
    }
  };

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
    this.shine(this.sun, this.sunTarget, 'sunMatrix');
    if (!this.litOnce) this.shine(this.sun, this.skyTarget, 'skyMatrix');
    this.litOnce = true;
    (this.shared['sun'] as { value: Vector3 }).value.copy(this.sun);
    this.camera.clearViewOffset();
    this.drawScene(null);
  }

  private drawScene(target: WebGLRenderTarget | null): void {
    const u = (this.mesh.material as RawShaderMaterial).uniforms;
    (this.shared['eye'] as { value: Vector3 }).value.copy(this.camera.position);
    const ratio = this.renderer.getPixelRatio();
    const pixels = this.renderer.domElement.height;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const mm = (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360)) / pixels;
    (u['dash'] as { value: number }).value = 2 ** Math.round(Math.log2(16 * ratio * mm));
    (u['ratio'] as { value: number }).value = ratio;
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

  /** The face at a place of the canvas in CSS pixels, or null: one pixel is drawn, with numbers for colours. */
  pick(x: number, y: number): number | null {
    if (this.lost || !this.lattice) return null;
    const width = this.canvas.clientWidth;
    const height = this.canvas.clientHeight;
    if (x < 0 || y < 0 || x >= width || y >= height) return null;
    this.camera.setViewOffset(width, height, x, y, 1, 1);
    this.renderer.setRenderTarget(this.whoTarget);
    this.renderer.setClearColor(0, 0);
    this.renderer.clear(true, true, false);
    this.renderer.render(this.whoScene, this.camera);
    const pixel = new Uint8Array(4);
    this.renderer.readRenderTargetPixels(this.whoTarget, 0, 0, 1, 1, pixel);
    this.renderer.setRenderTarget(null);
    this.camera.clearViewOffset();
    const id = (pixel[0] as number) + 256 * (pixel[1] as number) + 65536 * (pixel[2] as number);
    return id === 0 ? null : id - 1;
  }

  /** Where a place in the world (mm) lies on the canvas, in CSS pixels. */
  project(X: number, V: number, Z: number): { x: number; y: number; behind: boolean } {
    this.camera.updateMatrixWorld();
    const p = new Vector3(X, V, Z).project(this.camera);
    return {
      x: (p.x * 0.5 + 0.5) * this.canvas.clientWidth,
      y: (0.5 - p.y * 0.5) * this.canvas.clientHeight,
      behind: p.z > 1 || p.z < -1,
    };
  }

  private hover(): void {
    const at = this.hoverAt;
    this.hoverAt = null;
    if (!at) return;
    const face = this.pick(at.x, at.y);
    if (face !== this.hovered) {
      this.hovered = face;
      this.options.onHover?.(face);
    }
  }

  private readonly onPointerMove = (event: PointerEvent): void => {
    if (event.buttons !== 0 || event.pointerType === 'touch') return;
    this.hoverAt = { x: event.offsetX, y: event.offsetY };
    if (this.requested === 0) this.requested = requestAnimationFrame(this.tick);
  };

  private readonly onPointerLeave = (): void => {
    this.hoverAt = null;
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
    this.options.onPick?.(this.pick(event.offsetX, event.offsetY), event);
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
    return !this.changed && this.requested === 0;
  }

  /** The picture as PNG, with all that is gathered. */
  png(): Promise<Blob | null> {
    this.drawNow();
    this.gathered = 0;
    this.slow = false;
    while (this.gathered < this.framesToGather()) this.gather();
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
    if (this.requested) cancelAnimationFrame(this.requested);
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
    for (const mesh of [this.mesh, this.depthMesh, this.whoMesh, this.ghost, this.table]) (mesh.material as RawShaderMaterial).dispose();
    for (const target of [this.sunTarget, this.skyTarget, this.whoTarget, this.frameTarget, this.sumTarget]) target?.dispose();
    (this.shared['frames'] as { value: DataTexture | null }).value?.dispose();
    this.renderer.dispose();
  }
}

/** Same triangles with the same corners: positions can be blended. */
function sameTopology(a: Lattice, b: Lattice): boolean {
  if (a.motion !== 'pose' || b.motion !== 'pose') return false;
  if (a.triangles.length !== b.triangles.length || a.tips.length !== b.tips.length) return false;
  for (let i = 0; i < a.triangles.length; i++) if (a.triangles[i] !== b.triangles[i]) return false;
  return true;
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

