// SPDX-License-Identifier: MIT
// Writes the models of docs/gallery.md as OBJ with MTL: those that are made of boxes and formulas, and those of the npm
// packages teapot, bunny and @pmndrs/assets (with draco3dgltf). The same files each time.
//
// usage: node models.mjs FOLDER NPM [NAME ...]    NPM: the folder in which npm installed them; NAME: only these
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

const [folder, npm, ...wanted] = process.argv.slice(2);
const isWanted = (name) => wanted.length === 0 || wanted.includes(name);

// 1. Coloured triangles. x is toward you, y to the right, z up, in millimetres.

class Model {
  vertices = [];
  faces = new Map(); // colour -> lists of vertices

  point(p) {
    this.vertices.push(p);
    return this.vertices.length;
  }
  /** A flat face around its corners. */
  face(colour, corners) {
    if (!this.faces.has(colour)) this.faces.set(colour, []);
    this.faces.get(colour).push(corners.map((p) => this.point(p)));
  }
  box(colour, [x0, y0, z0], [x1, y1, z1]) {
    this.prism(colour, [[y0, z0], [y1, z0], [y1, z1], [y0, z1]], x0, x1);
  }
  /** An outline [y, z] that goes from x0 to x1. It must be convex. */
  prism(colour, outline, x0, x1, side = colour) {
    this.face(colour, outline.map(([y, z]) => [x1, y, z]));
    this.face(side, outline.map(([y, z]) => [x0, y, z]).reverse());
    outline.forEach(([y, z], k) => {
      const [v, w] = outline[(k + 1) % outline.length];
      this.face(side, [[x0, y, z], [x0, v, w], [x1, v, w], [x1, y, z]]);
    });
  }
  /** A picture on a wall that looks toward you: it stands out a little. */
  sign(colour, x, y0, z0, y1, z1, out = 0.6) {
    this.box(colour, [x - 0.1, y0, z0], [x + out, y1, z1]);
  }
  disc(colour, x0, x1, y, z, radius, corners = 48) {
    const turn = (k) => (2 * Math.PI * k) / corners;
    this.prism(colour, Array.from({ length: corners }, (_, k) =>
      [y + radius * Math.cos(turn(k)), z + radius * Math.sin(turn(k))]), x0, x1);
  }
  /** Turned about the upright line through (x, y): colour(k) and places [radius, z] from below. */
  turned(colour, x, y, profile, corners = 64) {
    const at = ([r, z], s) => {
      const turn = (2 * Math.PI * s) / corners;
      return [x + r * Math.cos(turn), y + r * Math.sin(turn), z];
    };
    for (let k = 0; k + 1 < profile.length; ++k)
      for (let s = 0; s < corners; ++s)
        this.face(colour(k, s),
          [at(profile[k], s), at(profile[k], s + 1), at(profile[k + 1], s + 1), at(profile[k + 1], s)]);
  }
  ball(colour, [x, y, z], radius) {
    const profile = Array.from({ length: 13 }, (_, k) => {
      const turn = Math.PI * (k / 12 - 0.5);
      return [radius * Math.cos(turn), z + radius * Math.sin(turn)];
    });
    this.turned(() => colour, x, y, profile, 24);
  }

  write(name) {
    const number = (n) => String(Math.round(n * 1e4) / 1e4);
    const lines = [`mtllib ${name}.mtl`, ...this.vertices.map((p) => `v ${p.map(number).join(' ')}`)];
    const colours = [];
    for (const [colour, faces] of this.faces) {
      lines.push(`usemtl c${colour}`, ...faces.map((f) => `f ${f.join(' ')}`));
      const part = (k) => number(parseInt(colour.slice(2 * k, 2 * k + 2), 16) / 255);
      colours.push(`newmtl c${colour}`, `Kd ${part(0)} ${part(1)} ${part(2)}`);
    }
    fs.writeFileSync(path.join(folder, `${name}.obj`), `${lines.join('\n')}\n`);
    fs.writeFileSync(path.join(folder, `${name}.mtl`), `${colours.join('\n')}\n`);
  }
}

/** Numbers from 0 to 1, the same for the same seed (Lehmer, 1951; Park and Miller's factor). */
function random(seed) {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

// 2. The models.

function house() {
  const m = new Model();
  const wall = 'f4d9a0', roof = 'b5442e', frame = 'fffdf5', glass = '5aa9d6';
  m.box(wall, [0, 0, 0], [40, 84, 40]);
  m.prism(wall, [[0, 40], [84, 40], [42, 74]], 0, 40);
  // Two slopes as thick boards, beyond the walls on all sides.
  for (const [y, end] of [[-6, 42], [90, 42]])
    m.prism(roof, y < 0 ? [[y, 33], [y, 39], [end, 79], [end, 73]] : [[end, 73], [end, 79], [y, 39], [y, 33]], -1, 47, '96361f');
  m.box('8d5a44', [10, 58, 50], [22, 68, 84]);
  m.box('5b3a2c', [9, 57, 84], [23, 69, 88]);
  const window = (y, z, w, h) => {
    m.sign(frame, 40, y - 1.5, z - 1.5, y + w + 1.5, z + h + 1.5, 1.2);
    m.sign(glass, 40, y, z, y + w / 2 - 0.6, z + h, 1.4);
    m.sign(glass, 40, y + w / 2 + 0.6, z, y + w, z + h, 1.4);
  };
  window(9, 14, 17, 16), window(58, 14, 17, 16), window(35, 45, 14, 12);
  m.sign(frame, 40, 33, 0, 51, 31, 1.2);
  m.sign('2f6f4f', 40, 35, 0, 49, 29, 1.6);
  m.sign('f0c040', 40, 45.5, 13, 47.5, 15, 2.4);
  m.box('9a9a96', [40, 30, 0], [50, 54, 4]);
  m.box('3f8f4a', [40, -2, 0], [48, 26, 8]), m.box('3f8f4a', [40, 58, 0], [48, 86, 8]);
  return m;
}

/** Two slopes as boards over walls from `y0` to `y1`, down to `low` beyond them; the ridge runs along x. */
function slopes(m, colour, [y0, y1], [x0, x1], walls, ridge, beyond, thick, side) {
  const middle = (y0 + y1) / 2, low = walls - (beyond * (ridge - walls)) / (middle - y0);
  m.prism(colour, [[y0 - beyond, low], [middle, ridge], [middle, ridge + thick], [y0 - beyond, low + thick]], x0, x1, side);
  m.prism(colour, [[middle, ridge], [y1 + beyond, low], [y1 + beyond, low + thick], [middle, ridge + thick]], x0, x1, side);
}

/** A nave, and a tower with a spire before it. */
function church() {
  const m = new Model();
  const wall = 'efe6d2', roof = '8a4b38', glass = '44679b', door = '5b3a2c';
  m.prism(wall, [[0, 0], [44, 0], [44, 28], [22, 52], [0, 28]], 0, 80);
  slopes(m, roof, [0, 44], [-3, 80], 28, 52, 4, 1.5, '6e3a2b');
  m.box('e4d8bf', [80, 10, 0], [104, 34, 66]);
  const top = [92, 22, 112];
  for (const [a, b] of [[[80, 10], [104, 10]], [[104, 10], [104, 34]], [[104, 34], [80, 34]], [[80, 34], [80, 10]]])
    m.face('5d6b78', [[...a, 66], [...b, 66], top]);
  m.sign(door, 104, 16, 0, 28, 20, 0.8), m.sign(glass, 104, 18, 44, 26, 58, 0.8);
  for (const x of [10, 32, 54])
    m.box(glass, [x, -0.6, 8], [x + 10, 0.1, 22]), m.box(glass, [x, 43.9, 8], [x + 10, 44.6, 22]);
  for (const [y0, y1] of [[9.4, 10.1], [33.9, 34.6]]) m.box(glass, [88, y0, 44], [96, y1, 58]);
  return m;
}

/** A wide roof on low walls, with a small tower on its ridge. */
function barn() {
  const m = new Model();
  const wall = 'a8322a', roof = '6b6f75', white = 'f6f2ea';
  m.prism(wall, [[0, 0], [64, 0], [64, 30], [32, 54], [0, 30]], 0, 90);
  slopes(m, roof, [0, 64], [-4, 94], 30, 54, 5, 1.5, '55585d');
  m.box(white, [40, 27, 46], [50, 37, 64]), m.prism(roof, [[25, 64], [39, 64], [32, 70]], 38, 52);
  m.sign(white, 90, 18, 0, 46, 26, 0.6), m.sign('8c261f', 90, 20, 0, 31, 24, 0.9), m.sign('8c261f', 90, 33, 0, 44, 24, 0.9);
  m.sign(white, 90, 27, 36, 37, 46, 0.6);
  for (const x of [12, 40, 68]) m.box(white, [x, -0.6, 10], [x + 10, 0.1, 20]), m.box(white, [x, 63.9, 10], [x + 10, 64.6, 20]);
  return m;
}

function city() {
  const m = new Model(), next = random(7);
  const whole = (low, high) => low + Math.floor(next() * (high - low + 1));
  const walls = ['e3b23c', 'c8553d', '588b8b', '8f7ab0', 'd9a48f', '6d8ea0', 'b7b34f'];
  for (let row = 0; row < 3; ++row)
    for (let k = 0; k < 5; ++k) {
      const x = 26 * (2 - row), y = 25 * k, wide = whole(16, 21), deep = whole(14, 18);
      const z = [whole(14, 26), whole(34, 58), whole(58, 96)][row];
      const colour = walls[whole(0, walls.length - 1)], y0 = y + whole(0, 3);
      m.box(colour, [x, y0, 0], [x + deep, y0 + wide, z]);
      for (let level = 6; level + 5 < z; level += 8)
        for (let w = 2.5; w + 3 < wide; w += 5)
          m.sign(next() < 0.35 ? 'fff2a8' : '33465c', x + deep, y0 + w, level, y0 + w + 3, level + 4.5, 0.3);
      if (row === 2 && k % 2 === 0) m.box('4a4a4a', [x + 5, y0 + 6, z], [x + 9, y0 + 10, z + 10]);
    }
  return m;
}

function car() {
  const m = new Model();
  const paint = 'd6322d', glass = '9fd3ea', tyre = '2b2b2b', trim = '7d1b18';
  m.prism(paint, [[0, 14], [4, 9], [126, 9], [130, 14], [130, 25], [122, 31], [95, 33], [20, 33], [2, 28]], 0, 46, trim);
  m.prism(paint, [[24, 33], [92, 33], [78, 55], [42, 55]], 5, 41, trim);
  // The windows of the side that looks toward you, the windscreen and the window behind.
  m.prism(glass, [[31, 34], [56, 34], [56, 51], [44, 51]], 40.5, 42);
  m.prism(glass, [[60, 34], [84, 34], [75, 51], [60, 51]], 40.5, 42);
  m.face(glass, [[8, 91, 34.8], [38, 91, 34.8], [37, 80.5, 52], [9, 80.5, 52]]);
  m.face(glass, [[8, 25.5, 35], [38, 25.5, 35], [37, 40, 52], [9, 40, 52]]);
  for (const y of [30, 101]) {
    m.disc(tyre, 34, 48, y, 13, 13), m.disc('d9d9d9', 48, 49, y, 13, 7), m.disc('8a8a8a', 49, 49.6, y, 13, 2.5);
    m.disc(tyre, 0, 10, y, 13, 13);
  }
  m.prism('fff0a0', [[122, 22], [129.9, 21], [129.9, 27], [124, 29]], 40, 47);
  m.prism('ff8a3c', [[0.1, 21], [6, 21], [6, 27], [1.5, 27]], 40, 47);
  m.sign('f2e9d8', 46, 58, 26, 65, 28, 0.8);
  m.box('5a5a5a', [0, -3, 7], [47, 6, 13]), m.box('5a5a5a', [0, 124, 7], [47, 133, 13]);
  return m;
}

function boat() {
  const m = new Model();
  m.prism('2d5f8b', [[14, 8], [96, 8], [110, 26], [4, 26]], 12, 34, '244d70');
  m.prism('f4f1e8', [[7, 22], [107, 22], [110, 26], [4, 26]], 11, 35);
  m.box('b98a54', [18, 34, 26], [28, 62, 33]);
  for (const y of [40, 48, 56]) m.disc('26394a', 28, 28.6, y, 29.5, 2, 24);
  m.box('7a4e2d', [21, 60, 26], [25, 63, 126]);
  m.prism('fff8e7', [[63, 34], [104, 38], [63, 122]], 21.5, 24.5);
  m.prism('f26b5b', [[63, 60], [91.7, 60], [84.3, 74], [63, 74]], 21, 25);
  m.prism('f7d26a', [[57, 36], [58, 112], [16, 36]], 19, 22);
  m.prism('e2413a', [[63, 126], [50, 122], [63, 118]], 22, 24);
  // Waves.
  const wave = (x, shift, colour) => {
    for (let k = 0; k < 4; ++k) {
      const y = 30 * k + shift;
      m.prism(colour, Array.from({ length: 9 }, (_, j) => [y + 30 - 3.75 * j, 7 + 5 * Math.sin((Math.PI * j) / 8)])
        .concat([[y, 0], [y + 30, 0]]), x, x + 10);
    }
  };
  wave(0, -2, '3d8fc4'), wave(38, -2, '5fb0dd');
  return m;
}

function lighthouse() {
  const m = new Model();
  const rings = [[34, 0], [32, 5], [26, 10], [20, 13], [18, 14]];
  m.turned((k, s) => ['77706a', '8a837a', '6b655f'][(k + Math.floor(s / 5)) % 3], 0, 0, [[0, 0], ...rings, [0, 14]]);
  const tower = Array.from({ length: 7 }, (_, k) => [16 - k, 14 + 11 * k]);
  m.turned((k) => (k % 2 ? 'f7f4ec' : 'c9302c'), 0, 0, tower);
  m.turned(() => '3c3c3c', 0, 0, [[0, 80], [15, 80], [15, 83], [0, 83]]);
  m.turned((k, s) => (s % 8 === 0 ? '3c3c3c' : 'ffd94a'), 0, 0, [[8.5, 83], [8.5, 97]]);
  m.turned(() => 'c9302c', 0, 0, [[0, 97], [11.5, 97], [7, 104], [2, 109], [1.2, 116], [0, 116]]);
  // A door and windows, on each side.
  for (let k = 0; k < 4; ++k) {
    const turn = Math.PI / 4 + (Math.PI / 2) * k, c = Math.cos(turn), s = Math.sin(turn);
    const board = (colour, low, high, half, r0, r1) => m.face(colour, [[-half, low], [half, low], [half, high], [-half, high]]
      .map(([a, z], n) => [(n < 2 ? r0 : r1) * c - a * s, (n < 2 ? r0 : r1) * s + a * c, z]));
    board('5b3a2c', 14, 28, 4, 16.6, 15.4), board('33465c', 41, 49, 2.5, 14.2, 13.5), board('33465c', 63, 71, 2.5, 12.2, 11.5);
  }
  return m;
}

function tree() {
  const m = new Model(), next = random(11);
  m.turned(() => '7a4e2d', 0, 0, [[0, 0], [6, 0], [6, 18], [0, 18]]);
  const cones = [[34, 16, 52], [27, 40, 74], [19, 63, 96]];
  cones.forEach(([r, low, high], k) =>
    m.turned((_, s) => (s % 8 < 4 ? '2e7d4f' : '37935d'), 0, 0, [[0, low], [r, low], [r - (r - 3 + k) * 0.93, high - 2], [0, high]]));
  const colours = ['e2413a', 'fcd34d', '3fa7d6', 'f28cb8', 'f4f1e8'];
  cones.forEach(([r, low, high], k) => {
    const count = [12, 9, 7][k];
    for (let j = 0; j < count; ++j) {
      const turn = (2 * Math.PI * (j + 0.5 * k)) / count, share = 0.12 + 0.5 * (j % 2) + 0.1 * next();
      const d = r * (1 - 0.93 * share) + 0.5;
      m.ball(colours[(j + k) % colours.length], [d * Math.cos(turn), d * Math.sin(turn), low + share * (high - low)], 3.2);
    }
  });
  m.ball('fcd34d', [0, 0, 99], 5.5);
  return m;
}

/** Meshes of npm packages, without colours. */
async function packages(require) {
  const obj = (name, positions, cells) => fs.writeFileSync(path.join(folder, `${name}.obj`), [
    ...positions.map((p) => `v ${p.join(' ')}`), ...cells.map((c) => `f ${c.map((i) => i + 1).join(' ')}`), ''].join('\n'));
  for (const name of ['teapot', 'bunny'].filter(isWanted)) {
    const mesh = require(name);
    obj(name, mesh.positions, mesh.cells);
  }
  if (!isWanted('monkey')) return;
  // Suzanne is a GLB, compressed by Draco, as base64.
  const text = fs.readFileSync(require.resolve('@pmndrs/assets/models/suzi.glb.js'), 'utf8');
  const glb = Buffer.from(text.match(/base64,([^'"]+)/)[1], 'base64');
  const length = glb.readUInt32LE(12), view = JSON.parse(glb.subarray(20, 20 + length)).bufferViews[0];
  const bytes = glb.subarray(28 + length + view.byteOffset).subarray(0, view.byteLength);
  const draco = await require('draco3dgltf').createDecoderModule({});
  const decoder = new draco.Decoder(), mesh = new draco.Mesh();
  decoder.DecodeArrayToMesh(new Int8Array(bytes), bytes.length, mesh);
  const places = new draco.DracoFloat32Array(), corners = new draco.DracoInt32Array();
  decoder.GetAttributeFloatForAllPoints(mesh, decoder.GetAttributeByUniqueId(mesh, 0), places);
  const three = (k, list) => [0, 1, 2].map((i) => list.GetValue(3 * k + i));
  const cells = Array.from({ length: mesh.num_faces() }, (_, k) => {
    decoder.GetFaceFromMesh(mesh, k, corners);
    return three(0, corners);
  });
  obj('monkey', Array.from({ length: mesh.num_points() }, (_, k) => three(k, places)), cells);
}

fs.mkdirSync(folder, { recursive: true });
for (const [name, make] of Object.entries({ house, church, barn, city, car, boat, lighthouse, tree }))
  if (isWanted(name)) make().write(name);
await packages(createRequire(path.join(path.resolve(npm), 'x')));
