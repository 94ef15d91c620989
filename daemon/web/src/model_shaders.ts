// SPDX-License-Identifier: MIT
// The shaders of the model. LINES: the lines of a triangle are drawn; SHADOWS: lights throw shadows;
// TIPS: some vertices are tips of V-folds; FRAMES: places come from a table of poses.

/** Triangles smaller than this many pixels are drawn without lines. */
export const kFaint_px = 2.5;

/** Where a vertex lies for psi. Its output vWorld is in mm. */
const kPlace = /* glsl */ `
precision highp float;
precision highp int;
in vec3 position;
in vec3 before;
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
out vec3 vWorld;
vec3 opened(vec3 p) {
  return vec3(p.x + p.y * pose.x, p.z, p.y * pose.y);
}
void place() {
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
  gl_Position = projectionMatrix * modelViewMatrix * vec4(world, 1.0);
}`;

/** Places alone: for depth. */
export const modelVertexShader = `${kPlace}
void main() {
  place();
}`;

/** Places and the number of the face: to find what is under the pointer. */
export const whoVertexShader = `${kPlace}
in float face;
flat out float vFace;
void main() {
  place();
  vFace = face;
}`;

/** `kinds` holds slice, level, flags (kind of face, 4 if merged, 8 if lit) and the roles of the sides (8 each). */
export const paperVertexShader = `${kPlace}
in float face;
in vec4 kinds;
in vec3 tint; // of the front
uniform vec3 accent;
uniform vec4 marked; // face, slice, level; w: 1 if any is lit
out vec3 vFront;
flat out float vOn;
#ifdef LINES
in float height; // from the side that is opposite to this corner, mm
in vec3 along;
in float size;
flat out vec3 vCut;
flat out vec3 vMountain;
flat out vec3 vDrawn;
flat out float vSize;
out vec3 vAcross;
out vec3 vAlong;
#endif
#ifdef SHADOWS
uniform mat4 sunMatrix, skyMatrix;
out vec3 vSun;
out vec3 vSky;
#endif
void main() {
  place();
  float flags = kinds.z;
  float kind = mod(flags, 4.0);
  bool on = flags >= 8.0 || marked.w > 0.5 && kind < 2.5 &&
    (abs(face - marked.x) < 0.5 || abs(kinds.x - marked.y) < 0.5 || abs(kinds.y - marked.z) < 0.5);
  vec3 base = tint;
  base = base * base * (base * 0.305306 + 0.682171) + base * 0.012522878;
  vOn = on ? 0.42 : 0.0;
  vFront = mix(base, accent * accent, vOn);
#ifdef LINES
  float r = kinds.w;
  vec3 role = vec3(mod(r, 8.0), mod(floor(r / 8.0), 8.0), floor(r / 64.0));
  vDrawn = step(0.5, role);
  vCut = 1.0 - step(1.5, role) * step(role, vec3(3.5));
  vMountain = step(role, vec3(2.5));
  vSize = size;
  int corner = gl_VertexID % 3;
  // A side is named by its first corner; the corner across from it is the one before that.
  vAcross = vec3(corner == 2 ? height : 0.0, corner == 0 ? height : 0.0, corner == 1 ? height : 0.0);
  vAlong = along;
#endif
#ifdef SHADOWS
  vec4 s = sunMatrix * vec4(vWorld, 1.0);
  vSun = s.xyz * 0.5 + 0.5;
  s = skyMatrix * vec4(vWorld, 1.0);
  vSky = s.xyz * 0.5 + 0.5;
#endif
}`;

const kSeen = /* glsl */ `
uniform highp sampler2DShadow sunMap, skyMap;
uniform vec3 sun, sky;
uniform float gathering;
float seen(highp sampler2DShadow map, vec3 at, float bias) {
  if (at.x <= 0.0 || at.x >= 1.0 || at.y <= 0.0 || at.y >= 1.0) return 1.0;
  return texture(map, vec3(at.xy, at.z - bias));
}
`;

export const paperFragmentShader = /* glsl */ `
precision highp float;
precision highp int;
in vec3 vWorld;
in vec3 vFront;
flat in float vOn;
uniform vec3 back, accent;
uniform float dim;
out vec4 colour;
#ifdef SHADOWS
in vec3 vSun;
in vec3 vSky;
${kSeen}
#else
uniform vec3 sun;
#endif
// Direct light and light of the sky on a surface that faces n, in linear light.
vec3 lit(vec3 n) {
  float d = dot(n, sun);
  float s = max(d, 0.0);
  float a = 0.44 + 0.44 * n.z;
#ifdef SHADOWS
  float bias = 0.0052 - 0.004 * abs(d);
  if (d > 0.0) s *= seen(sunMap, vSun, bias);
  if (gathering > 0.5) {
    float e = dot(n, sky);
    a = e > 0.0 ? 2.0 * e * seen(skyMap, vSky, bias) : 0.0;
  }
#endif
  float through = max(-d, 0.0) * 0.10;
  vec3 warm = vec3(1.0, 0.965, 0.90), cool = vec3(0.352, 0.376, 0.40);
  return warm * (0.68 * s + through) + cool * a + vec3(0.17, 0.165, 0.16);
}
// The power 1/2.2 of what is 0 to 1, to 0.004: three roots are cheaper than three powers.
vec3 shown(vec3 linear) {
  vec3 a = sqrt(clamp(linear, 0.0, 1.0));
  vec3 b = sqrt(a);
  return 0.585122381 * a + 0.783140355 * b - 0.368262736 * sqrt(b);
}
#ifdef LINES
in vec3 vAcross;
in vec3 vAlong;
flat in vec3 vCut;
flat in vec3 vMountain;
flat in vec3 vDrawn;
flat in float vSize;
uniform vec3 inkCut, inkMountain, inkValley;
uniform float dash, ratio;
// How much of a dash covers the places t, which go from 0 to 1 along it.
vec3 within(vec3 t, vec3 middle, vec3 half_) {
  return clamp((half_ - abs(t - middle)) * 16.0 + 0.5, 0.0, 1.0);
}
#endif
void main() {
  // Seen from the eye, right across up points to the eye.
  vec3 n = normalize(cross(dFdx(vWorld), dFdy(vWorld)));
  vec3 base = gl_FrontFacing ? vFront : mix(back, accent * accent, vOn);
  vec3 c = shown(base * lit(n));
#ifdef LINES
  // Derivatives must be taken outside of branches that differ between pixels.
  vec3 pixels = 1.0 / max(fwidth(vAcross), 1e-5);
  vec3 width = mix(vec3(0.78), vec3(0.62), vCut) * ratio + 0.6;
  vec3 ink = clamp((width - vAcross * pixels) * 0.8333333, 0.0, 1.0) * vDrawn * clamp((vSize * pixels - ${kFaint_px}) * 0.1538, 0.0, 1.0);
  // A loop of no or one turn: what draws without a graphics card leaves it out where no line is near.
  int turns = ink.x + ink.y + ink.z > 0.0 ? 1 : 0;
  for (int turn = 0; turn < turns; turn++) {
    vec3 t = fract(vAlong / dash);
    // Valleys: two dashes. Mountains: a long one and a dot.
    vec3 first = mix(vec3(0.14), vec3(0.26), vMountain);
    vec3 covered = within(t, first, first) + within(t, mix(vec3(0.64), vec3(0.76), vMountain), mix(vec3(0.14), vec3(0.06), vMountain));
    ink *= mix(covered * 0.8, vec3(0.72), vCut);
    c = mix(c, vCut.x > 0.5 ? inkCut : vMountain.x > 0.5 ? inkMountain : inkValley, ink.x);
    c = mix(c, vCut.y > 0.5 ? inkCut : vMountain.y > 0.5 ? inkMountain : inkValley, ink.y);
    c = mix(c, vCut.z > 0.5 ? inkCut : vMountain.z > 0.5 ? inkMountain : inkValley, ink.z);
  }
#endif
  colour = vec4(mix(c, vec3(dot(c, vec3(0.3333))), dim * 0.8), 1.0);
}`;

export const depthFragmentShader = /* glsl */ `
precision highp float;
out vec4 colour;
void main() {
  colour = vec4(1.0);
}`;

export const whoFragmentShader = /* glsl */ `
precision highp float;
precision highp int;
flat in float vFace;
out vec4 colour;
void main() {
  int id = int(vFace + 0.5) + 1;
  colour = vec4(float(id & 255), float((id >> 8) & 255), float((id >> 16) & 255), 255.0) / 255.0;
}`;

export const tableVertexShader = /* glsl */ `
precision highp float;
in vec3 position;
uniform mat4 modelMatrix, viewMatrix, projectionMatrix, sunMatrix, skyMatrix;
out vec3 vSun;
out vec3 vSky;
out float vOut;
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  vOut = length(position.xy);
  vSun = (sunMatrix * world).xyz * 0.5 + 0.5;
  vSky = (skyMatrix * world).xyz * 0.5 + 0.5;
  gl_Position = projectionMatrix * viewMatrix * world;
}`;

export const tableFragmentShader = /* glsl */ `
precision highp float;
in vec3 vSun;
in vec3 vSky;
in float vOut;
uniform vec3 ground;
uniform float dark;
out vec4 colour;
${kSeen}
void main() {
  float s = seen(sunMap, vSun, 0.001);
  float a = gathering > 0.5 ? 2.0 * max(0.0, sky.z) * seen(skyMap, vSky, 0.001) : 1.0;
  float full = 0.66 * sun.z + 0.36;
  a = mix(1.0, a, 0.4);
  float light = (0.66 * sun.z * s + 0.36 * a) / full;
  light = mix(1.0, light, (1.0 - smoothstep(0.13, 0.25, vOut)) * dark);
  colour = vec4(ground * pow(max(light, 0.0), 0.5), 1.0);
}`;

export const ghostVertexShader = /* glsl */ `
precision highp float;
in vec3 position;
uniform mat4 modelViewMatrix, projectionMatrix;
out vec3 vWorld;
void main() {
  vWorld = position;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const ghostFragmentShader = /* glsl */ `
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

export const screenVertexShader = /* glsl */ `
precision highp float;
in vec3 position;
out vec2 at;
void main() {
  at = position.xy * 0.5 + 0.5;
  gl_Position = vec4(position.xy, 0.0, 1.0);
}`;

export const copyFragmentShader = /* glsl */ `
precision highp float;
in vec2 at;
uniform sampler2D from;
uniform float opacity;
out vec4 colour;
void main() {
  colour = vec4(texture(from, at).rgb, opacity);
}`;
