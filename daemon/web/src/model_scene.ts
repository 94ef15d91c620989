// SPDX-License-Identifier: MIT
// A model as popcutd gets it: read with its colours, drawn from the sides that it may show, and packed into one file.
// Loaded when somebody opens a model.
import {
  Box3, BufferAttribute, BufferGeometry, Color, ColorManagement, DirectionalLight, DoubleSide, Group, HemisphereLight, LoadingManager,
  Material, Mesh, MeshLambertMaterial, MeshStandardMaterial, OrthographicCamera, Scene, TextureLoader, Vector3,
  WebGLRenderer, type Texture,
} from 'three';
import { GLTFExporter } from 'three/examples/jsm/exporters/GLTFExporter.js';
import { GLTFLoader } from 'three/examples/jsm/loaders/GLTFLoader.js';
import { MTLLoader } from 'three/examples/jsm/loaders/MTLLoader.js';
import { OBJLoader } from 'three/examples/jsm/loaders/OBJLoader.js';
import { mergeVertices } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import { endingOf, fileFor, frontsOf, nameOf, pixelsOf, type Axis, type Given } from './model_files';

/** What of a model's colours is not there, or cannot be read. */
export interface Lack {
  kind: 'missing' | 'too-large' | 'unreadable' | 'other-model';
  name: string;
  pixels?: [number, number];
}

/** A model that was read. */
export interface Read {
  scene: Group;
  up: 'y' | 'z';       // as files of its kind usually stand
  lacks: Lack[];
  coloured: boolean;   // it has colours of its own
  text: string | null; // of an OBJ
}

const kMostPixels = 64_000_000;
const kMostSide_px = 4096;   // of pictures in what is packed
const kFarthest = 1e9;
const kClay = 0xcca07e;

const vector = (axis: Axis): Vector3 => {
  const sign = axis.startsWith('-') ? -1 : 1;
  const letter = axis.slice(-1);
  return new Vector3(letter === 'x' ? sign : 0, letter === 'y' ? sign : 0, letter === 'z' ? sign : 0);
};

/** What is read or drawn here has colours that are mixed as light is; elsewhere on the page they are not. */
function inLight<T>(what: () => T): T {
  const before = ColorManagement.enabled;
  ColorManagement.enabled = true;
  try {
    return what();
  } finally {
    ColorManagement.enabled = before;
  }
}

function stlGeometry(buffer: ArrayBuffer): BufferGeometry {
  const view = new DataView(buffer);
  const said = buffer.byteLength >= 84 ? view.getUint32(80, true) : 0;
  const isBinary = buffer.byteLength === 84 + 50 * said;
  const numbers = isBinary ? new Float32Array(9 * said) : textNumbers(buffer);
  if (isBinary) for (let t = 0; t < said; t++) for (let k = 0; k < 9; k++) numbers[9 * t + k] = view.getFloat32(84 + 50 * t + 12 + 4 * k, true);
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(numbers, 3));
  return geometry;
}

function textNumbers(buffer: ArrayBuffer): Float32Array {
  const out: number[] = [];
  for (const line of new TextDecoder().decode(buffer).matchAll(/^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)/gm)) out.push(Number(line[1]), Number(line[2]), Number(line[3]));
  return Float32Array.from(out.slice(0, out.length - (out.length % 9)));
}

const namesIn = (text: string, word: string): string[] =>
  [...new Set([...text.matchAll(new RegExp(`^[ \\t]*${word}[ \\t]+(.+?)[ \\t\\r]*$`, 'gm'))].map((line) => line[1] as string))];

/** The name of the picture in a line `map_Kd`, which may have options before it. */
const pictureIn = (line: string): string => line.replace(/^(-\w+(\s+[-\d.]+|\s+on|\s+off)*\s+)+/, '');

const isColour = (line: string): boolean => !/^\s*(map_(?!Kd\b)|bump|disp|decal|refl|norm)/i.test(line);

interface Colours {
  text: string;                       // of all MTL files, with pictures that are there
  pictures: Map<string, Given>;
}

async function coloursOf(text: string, beside: readonly Given[], lacks: Lack[]): Promise<Colours> {
  const used = namesIn(text, 'usemtl');
  const libraries = beside.filter((one) => endingOf(one.path) === 'mtl');
  const found: Given[] = [];
  const missing: string[] = [];
  for (const name of namesIn(text, 'mtllib')) {
    const one = fileFor(name, libraries);
    if (one) found.push(one);
    else missing.push(name);
  }
  let colours = '';
  // One that nobody names may be meant, if it has what is used.
  for (const one of missing.length > 0 ? libraries : found) {
    const inIt = await one.file.text();
    const has = namesIn(inIt, 'newmtl');
    if (used.length === 0 || used.some((name) => has.includes(name))) colours += `${inIt}\n`;
    else lacks.push({ kind: 'other-model', name: nameOf(one.path) });
  }
  if (colours === '' && !lacks.some((one) => one.kind === 'other-model')) lacks.push(...missing.map((name): Lack => ({ kind: 'missing', name: nameOf(name) })));
  const pictures = new Map<string, Given>();
  const kept: string[] = [];
  for (const line of colours.split(/\r?\n/).filter(isColour)) {
    const name = /^\s*map_Kd\s+(.+?)\s*$/i.exec(line)?.[1];
    if (name === undefined) {
      kept.push(line);
      continue;
    }
    const one = fileFor(pictureIn(name), beside.filter((each) => endingOf(each.path) !== 'mtl'));
    const known = lacks.some((lack) => lack.name === nameOf(pictureIn(name)));
    const pixels = one ? await pixelsOf(one.file) : null;
    if (!one) {
      if (!known) lacks.push({ kind: 'missing', name: nameOf(pictureIn(name)) });
    } else if (pixels && pixels[0] * pixels[1] > kMostPixels) {
      if (!known) lacks.push({ kind: 'too-large', name: nameOf(one.path), pixels });
    } else {
      pictures.set(nameOf(pictureIn(name)), one);
      kept.push(line);
    }
  }
  return { text: kept.join('\n'), pictures };
}

/** Plain colours: popcut prints no shine, and a material that is clear by mistake is to be seen. */
function plain(from: Material & { color?: Color; map?: Texture | null; vertexColors: boolean }): MeshStandardMaterial {
  const made = new MeshStandardMaterial({ map: from.map ?? null, vertexColors: from.vertexColors, metalness: 0, roughness: 1, side: DoubleSide });
  made.name = from.name;
  if (from.color) made.color.copy(from.color);
  return made;
}

function meshesOf(scene: Group): Mesh[] {
  const out: Mesh[] = [];
  scene.traverse((one) => { if (one instanceof Mesh) out.push(one); });
  return out;
}

async function readObj(given: Given, beside: readonly Given[]): Promise<Read> {
  const text = await given.file.text();
  const lacks: Lack[] = [];
  const colours = await coloursOf(text, beside, lacks);
  const addresses = new Map([...colours.pictures].map(([name, one]) => [name, URL.createObjectURL(one.file)]));
  const manager = new LoadingManager();
  manager.setURLModifier((address) => addresses.get(nameOf(address)) ?? address);
  let left = false;
  const loaded = new Promise<void>((done) => { manager.onLoad = () => { left = true; done(); }; });
  manager.onError = (address) => {
    const name = [...addresses].find(([, one]) => one === address)?.[0] ?? nameOf(address);
    lacks.push({ kind: 'unreadable', name });
  };
  const scene = inLight(() => {
    const loader = new OBJLoader();
    if (colours.text !== '') {
      const materials = new MTLLoader(manager).parse(colours.text, '');
      materials.preload();
      loader.setMaterials(materials);
    }
    return loader.parse(text);
  });
  if (colours.pictures.size > 0 && !left) await loaded;
  for (const address of addresses.values()) URL.revokeObjectURL(address);
  for (const one of [...scene.children]) if (!(one instanceof Mesh)) scene.remove(one);
  for (const mesh of meshesOf(scene)) {
    const spoiled = (map: Texture | null | undefined): boolean => !map || !(map.image as HTMLImageElement | undefined)?.naturalWidth;
    const of = (material: Material): Material => {
      const made = plain(material as Parameters<typeof plain>[0]);
      if (colours.text.trim() === '' && !made.vertexColors) made.color.set(kClay);
      if (spoiled(made.map)) made.map = null;
      else if (endingOf(colours.pictures.get(material.name)?.path ?? '') !== 'png') made.map!.userData.mimeType = 'image/jpeg';
      return made;
    };
    mesh.material = Array.isArray(mesh.material) ? mesh.material.map(of) : of(mesh.material as Material);
  }
  return { scene, up: 'y', lacks, coloured: colours.text.trim() !== '', text };
}

async function readGlb(given: Given): Promise<Group> {
  const loader = new GLTFLoader();
  // The policy of the page lets pictures be shown that are in it, but not be fetched.
  loader.register((parser) => {
    (parser as unknown as { textureLoader: TextureLoader }).textureLoader = new TextureLoader();
    return { name: 'popcut_pictures' };
  });
  const bytes = await given.file.arrayBuffer();
  return inLight(() => loader.parseAsync(bytes, '')).then(({ scene }) => scene as Group);
}

/** Reads a model, its colours from the files `beside` it. Null: it is nothing that can be drawn; popcutd says why. */
export async function readModel(given: Given, beside: readonly Given[]): Promise<Read | null> {
  let read: Read;
  try {
    const kind = endingOf(given.path);
    if (kind === 'obj') read = await readObj(given, beside);
    else if (kind === 'glb') read = { scene: await readGlb(given), up: 'y', lacks: [], coloured: true, text: null };
    else {
      const scene = new Group();
      scene.add(new Mesh(stlGeometry(await given.file.arrayBuffer()), new MeshStandardMaterial({ color: kClay })));
      read = { scene, up: 'z', lacks: [], coloured: false, text: null };
    }
  } catch {
    return null;
  }
  const places = meshesOf(read.scene).map((mesh) => mesh.geometry.getAttribute('position')?.array ?? []);
  if (!places.every((of) => Array.prototype.every.call(of, Number.isFinite))) return null;
  read.scene.updateMatrixWorld(true);
  const size = new Box3().setFromObject(read.scene).getSize(new Vector3());
  const drawn = [size.x, size.y, size.z].every((one) => one > 0 && one < kFarthest);
  return drawn && size.length() > 1 / kFarthest ? read : null;
}

/** The model as one file: an OBJ with what lies beside it as a GLB, all else as it is. `clay`: without its colours. */
export async function packed(of: Read, given: Given, clay: boolean): Promise<{ bytes: Blob; name: string; type: string }> {
  const types: Record<string, string> = { stl: 'model/stl', obj: 'model/obj', glb: 'model/gltf-binary' };
  const name = nameOf(given.path);
  if (of.text !== null && (clay || !of.coloured)) {
    return { bytes: new Blob([of.text.replace(/^[ \t]*(mtllib|usemtl)\b.*$/gm, '')]), name, type: types.obj as string };
  }
  if (of.text === null) return { bytes: given.file, name, type: types[endingOf(name)] as string };
  for (const mesh of meshesOf(of.scene)) {
    mesh.geometry.deleteAttribute('normal');
    mesh.geometry = mergeVertices(mesh.geometry);
  }
  const bytes = await new GLTFExporter().parseAsync(of.scene, { binary: true, maxTextureSize: kMostSide_px, onlyVisible: false });
  return { bytes: new Blob([bytes as ArrayBuffer]), name: name.replace(/\.[^.]*$/, '.glb'), type: types.glb as string };
}

export const trianglesOf = ({ scene }: Read): number => meshesOf(scene).reduce((sum, { geometry }) =>
  sum + (geometry.index ?? geometry.getAttribute('position')).count / 3, 0);

/** Draws models from many sides. */
export class Sides {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new OrthographicCamera();
  private readonly corners: Vector3[];

  /** Throws where the browser has no WebGL. */
  constructor(model: Group, private readonly size_px: number) {
    const how = { antialias: true, alpha: true, preserveDrawingBuffer: true };
    // Where three finds none itself, it complains in the console.
    const context = document.createElement('canvas').getContext('webgl2', how) as WebGL2RenderingContext | null;
    if (!context) throw new Error('no WebGL');
    this.renderer = new WebGLRenderer({ ...how, canvas: context.canvas as HTMLCanvasElement, context });
    this.renderer.setSize(size_px, size_px, false);
    const light = new DirectionalLight(0xffffff, 1.7);
    light.position.set(-0.5, 0.8, 1);
    this.camera.add(light);
    this.scene.add(new HemisphereLight(0xffffff, 0xb9b2a6, 1.9), this.camera);
    const shown = model.clone();
    for (const mesh of meshesOf(shown)) {
      if (!mesh.geometry.getAttribute('normal')) mesh.geometry.computeVertexNormals();
      const of = (from: Material): Material => {
        const { color, map, vertexColors } = from as MeshStandardMaterial;
        return new MeshLambertMaterial({ color: color ?? new Color(0xffffff), map: map ?? null, vertexColors, side: DoubleSide });
      };
      mesh.material = Array.isArray(mesh.material) ? mesh.material.map(of) : of(mesh.material as Material);
    }
    this.scene.add(shown);
    const { min, max } = new Box3().setFromObject(shown);
    this.corners = [...Array(8).keys()].map((k) => new Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z));
  }

  /** Looks along -`front`, from `above` it. */
  private draw(up: Axis, front: Axis, above: number): void {
    const { camera, corners } = this;
    const middle = corners.reduce((sum, one) => sum.add(one), new Vector3()).divideScalar(8);
    const toward = vector(front).addScaledVector(vector(up), above).normalize();
    const reach = corners.reduce((most, one) => Math.max(most, one.distanceTo(middle)), 0);
    camera.up.copy(vector(up));
    camera.position.copy(middle).addScaledVector(toward, 2 * reach);
    camera.lookAt(middle);
    camera.updateMatrixWorld();
    const most = corners.reduce((so_far, one) => {
      const seen = one.clone().applyMatrix4(camera.matrixWorldInverse);
      return Math.max(so_far, Math.abs(seen.x), Math.abs(seen.y));
    }, 0) * 1.06;
    camera.left = camera.bottom = -most;
    camera.right = camera.top = most;
    camera.near = 0;
    camera.far = 4 * reach;
    camera.updateProjectionMatrix();
    inLight(() => this.renderer.render(this.scene, camera));
  }

  /** A picture as an address that an image can show. */
  async picture(up: Axis, front: Axis): Promise<string> {
    this.draw(up, front, 0.35);
    const blob = await new Promise<Blob | null>((done) => this.renderer.domElement.toBlob(done, 'image/png'));
    return blob ? URL.createObjectURL(blob) : '';
  }

  /** How long the outline and the borders of colours are, seen from in front: a back shows less than a face. */
  private detail(up: Axis, front: Axis): number {
    this.draw(up, front, 0.35);
    const { size_px, camera } = this;
    const gl = this.renderer.getContext();
    const pixels = new Uint8Array(4 * size_px * size_px);
    gl.readPixels(0, 0, size_px, size_px, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const differ = (a: number, b: number): boolean =>
      [0, 1, 2, 3].some((k) => Math.abs((pixels[a + k] as number) - (pixels[b + k] ?? 0)) > 48);
    let count = 0;
    for (let i = 0; i < pixels.length; i += 4) if (differ(i, i + 4) || differ(i, i + 4 * size_px)) count++;
    return count * (camera.right - camera.left);
  }

  /** The front that shows most. Of two that show about as much, the usual one. */
  guess(up: Axis): Axis {
    const kClearly = 1.03;
    let [best, most] = ['z' as Axis, 0];
    for (const front of frontsOf(up)) {
      const seen = this.detail(up, front);
      if (seen > kClearly * most) [best, most] = [front, seen];
    }
    return best;
  }

  dispose(): void {
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

