#pragma once

namespace springtower {

// OpenGL 3.3 core. `local` is a place on a block in its own axes, metres from its middle: wood is a solid, so that the ends show
// the rings of which the sides show the grain. Everything that repeats fades out where its period comes near to a pixel.

inline constexpr const char* kVertexShader = R"glsl(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 local;
layout(location = 3) in vec3 colour;
layout(location = 4) in int block;
uniform mat4 clipFromWorld;
uniform mat4 lightFromWorld;
out vec3 vWorld;
out vec3 vNormal;
out vec3 vLocal;
out vec3 vColour;
out vec4 vLight;
flat out int vBlock;
void main() {
  vWorld = position;
  vNormal = normal;
  vLocal = local;
  vColour = colour;
  vLight = lightFromWorld * vec4(position + 0.0006 * normal, 1.0);
  vBlock = block;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
)glsl";

// What both kinds of surface use: noise, shadow and light.
inline constexpr const char* kCommonShader = R"glsl(#version 330 core
in vec3 vWorld;
in vec3 vNormal;
in vec3 vLocal;
in vec3 vColour;
in vec4 vLight;
flat in int vBlock;
uniform sampler2DShadow shadow;
uniform vec3 toLight;
uniform vec3 background;
uniform vec3 eye;
out vec4 result;

float random(vec2 at) {
  vec2 p = fract(at * vec2(0.1031, 0.1137));
  p += dot(p, p.yx + 33.33);
  return fract((p.x + p.y) * p.x);
}

// Smooth noise of period 1, about 0.5, that fades where a pixel is as wide as its period.
float noise(vec2 at) {
  vec2 wide = fwidth(at);
  float shown = 1.0 - smoothstep(0.35, 0.9, max(wide.x, wide.y));
  vec2 cell = floor(at);
  vec2 f = at - cell;
  f = f * f * (3.0 - 2.0 * f);
  float low = mix(random(cell), random(cell + vec2(1.0, 0.0)), f.x);
  float high = mix(random(cell + vec2(0.0, 1.0)), random(cell + vec2(1.0, 1.0)), f.x);
  return mix(0.5, mix(low, high, f.y), shown);
}

float sunlit() {
  vec3 at = 0.5 * vLight.xyz + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float size = 2.2 / float(textureSize(shadow, 0).x);
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) {
    vec2 off = (vec2(float(i % 3), float(i / 3)) - 1.0) * size;
    sum += texture(shadow, vec3(at.xy + off, at.z - 0.0008));
  }
  return sum / 9.0;
}

// Warm sun, cool sky, and what a warm table throws back; `open`: how much of the sky is seen.
vec3 light(vec3 n, float sun, float open) {
  vec3 sky = vec3(0.94, 0.97, 1.00) * (0.5 + 0.5 * n.z) * 0.36;
  vec3 fill = vec3(1.00, 0.96, 0.91) * (0.27 + 0.14 * max(dot(n, vec3(0.8, 0.5, 0.33)), 0.0));
  vec3 bounce = vec3(1.00, 0.86, 0.72) * (0.5 - 0.5 * n.z) * 0.14;
  return (sky + fill + bounce) * open + vec3(1.00, 0.95, 0.87) * 0.56 * sun * mix(0.6, 1.0, open);
}
)glsl";

inline constexpr const char* kBlockShader = R"glsl(
uniform int highlighted;
uniform samplerBuffer boxes;   // of each block: its centre, then three unit axes with half its size along them
uniform isamplerBuffer nearby; // of each block: eight that are near it, -1 for none

// How much of the sky is seen from a place on a block, with what is near it in the way (view/occlusion.h has the same for the table).
float openness(vec3 at, vec3 n) {
  const float reach = 0.024;
  const float lift = 0.004;
  float open = 1.0;
  for (int i = 0; i < 8; ++i) {
    int other = texelFetch(nearby, 8 * vBlock + i).r;
    if (other < 0) break;
    vec3 away = at + lift * n - texelFetch(boxes, 4 * other).xyz;
    vec3 way = lift * n;
    for (int a = 0; a < 3; ++a) {
      vec4 axis = texelFetch(boxes, 4 * other + 1 + a);
      float along = dot(away, axis.xyz);
      way += (clamp(along, -axis.w, axis.w) - along) * axis.xyz;
    }
    float far = length(way);
    float near = max(0.0, 1.0 - far / reach);
    open *= 1.0 - 0.92 * max(0.0, dot(way, n) / max(far, 1e-5)) * near * near;
  }
  return open;
}

// Brightness of wood around 1: rings round a pith beside the block, and fibres along it.
float wood(float end) {
  float seed = float(vBlock);
  float angle = 6.2832 * random(vec2(seed, 1.0));
  vec2 pith = vec2(cos(angle), sin(angle)) * (0.018 + 0.03 * random(vec2(seed, 2.0)));
  vec2 across = vLocal.yz - pith;
  across += 0.0016 * (vec2(noise(vec2(14.0 * vLocal.x + seed, 3.0)), noise(vec2(14.0 * vLocal.x - seed, 7.0))) - 0.5);
  float ring = length(across) / 0.0021 + 0.9 * noise(vec2(210.0 * vLocal.y + seed, 210.0 * vLocal.z + 19.0 * vLocal.x));
  float shown = 1.0 - smoothstep(0.25, 0.8, fwidth(ring));
  float part = fract(ring);
  float late = smoothstep(0.15, 0.8, part) * (1.0 - smoothstep(0.86, 1.0, part));
  float turn = atan(across.y, across.x) * length(across);
  float fibre = mix(noise(vec2(55.0 * vLocal.x + 3.0 * seed, 2100.0 * turn)), noise(1900.0 * across), end);
  return 1.0 - mix(0.055, 0.085, end) * (late - 0.38) * shown + mix(0.05, 0.09, end) * (fibre - 0.5);
}

void main() {
  vec3 n = normalize(vNormal);
  vec4 axes[3];
  vec3 toEdge;
  for (int a = 0; a < 3; ++a) {
    axes[a] = texelFetch(boxes, 4 * vBlock + 1 + a);
    toEdge[a] = axes[a].w - abs(vLocal[a]);
  }
  // The face lies across the axis to whose end it is nearest; the nearer of its edges is rounded.
  int face = toEdge.x < toEdge.y ? (toEdge.x < toEdge.z ? 0 : 2) : (toEdge.y < toEdge.z ? 1 : 2);
  float end = face == 0 ? 1.0 : 0.0;
  int u = face == 0 ? 1 : 0;
  int v = face == 2 ? 1 : 2;
  int across = toEdge[u] < toEdge[v] ? u : v;
  float edge = toEdge[across];
  float pixel = length(fwidth(vLocal));
  float round = max(0.0007, 0.8 * pixel);
  float bend = 1.0 - smoothstep(0.0, round, edge);
  vec3 out_ = axes[across].xyz * sign(vLocal[across]);
  vec3 bent = normalize(n + 0.8 * bend * out_);
  float open = openness(vWorld, n) * mix(1.0, 0.62, bend);
  float sun = max(dot(bent, toLight), 0.0) * sunlit();
  vec3 colour = vColour * wood(end) * mix(1.0, ENDGRAIN, end) * (highlighted == vBlock ? 1.16 : 1.0);
  vec3 half_ = normalize(toLight + normalize(eye - vWorld));
  float shine = pow(max(dot(bent, half_), 0.0), 30.0) * 0.10 * sun;
  result = vec4(colour * light(bent, sun, open) + shine, 1.0);
}
)glsl";

inline constexpr const char* kFloorShader = R"glsl(
uniform sampler2D floorOpen;  // how much of the sky is seen from the floor
uniform vec3 floorOpenPlace;  // its lower corner and its side, m
uniform vec2 floorMiddle;
uniform float floorRadius;
uniform vec3 table;
uniform int grid;

// An engineer's floor: a grid of 2 cm, every fifth line stronger, that fades out.
vec3 squares(vec2 from, float sun, float open) {
  vec2 width = max(fwidth(from), vec2(1e-6));
  vec2 fine = abs(fract(from / 0.02 - 0.5) - 0.5) * 0.02 / width;
  vec2 strong = abs(fract(from / 0.1 - 0.5) - 0.5) * 0.1 / width;
  float far = clamp(1.0 - max(width.x, width.y) / 0.008, 0.0, 1.0);
  float lines = max(0.07 * (1.0 - min(min(fine.x, fine.y), 1.0)) * far, 0.16 * (1.0 - min(min(strong.x, strong.y), 1.0)));
  vec3 base = vec3(0.92, 0.915, 0.90) * mix(0.66, 1.0, sun) * open;
  return mix(base * (1.0 - lines), background, smoothstep(0.15, 0.75, length(from - floorMiddle) / floorRadius));
}

// Boards of 11 cm, each with its own grain and tone.
vec3 boards(vec2 from) {
  float row = floor(from.y / 0.11);
  float inRow = from.y / 0.11 - row;
  float seam = min(inRow, 1.0 - inRow) * 0.11;
  float tone = 0.90 + 0.18 * random(vec2(row, 5.0));
  float grain = noise(vec2(9.0 * from.x + 7.0 * row, 260.0 * from.y)) - 0.5;
  float wide = noise(vec2(3.0 * from.x + 13.0 * row, 42.0 * from.y)) - 0.5;
  float pixel = fwidth(from.y);
  float line = (1.0 - smoothstep(0.0004, 0.0004 + 1.5 * pixel, seam)) * (1.0 - smoothstep(0.004, 0.02, pixel));
  return table * tone * (1.0 + 0.10 * grain + 0.13 * wide) * (1.0 - 0.45 * line);
}

void main() {
  vec3 n = normalize(vNormal);
  vec2 from = vWorld.xy;
  vec2 place = (from - floorOpenPlace.xy) / floorOpenPlace.z;
  bool known = all(greaterThan(place, vec2(0.0))) && all(lessThan(place, vec2(1.0)));
  float open = known ? texture(floorOpen, place).r : 1.0;
  float sun = sunlit();
  if (grid != 0) {
    result = vec4(squares(from, sun, open), 1.0);
    return;
  }
  float rim = smoothstep(floorRadius - 0.010, floorRadius, length(from - floorMiddle));
  vec3 side = n.z > 0.5 ? normalize(vec3((from - floorMiddle) * rim / floorRadius, 1.0)) : n;
  float direct = max(dot(side, toLight), 0.0) * sun;
  vec3 half_ = normalize(toLight + normalize(eye - vWorld));
  float shine = pow(max(dot(side, half_), 0.0), 18.0) * 0.10 * direct;
  result = vec4(boards(n.z > 0.5 ? from : vec2(from.x, from.y + vWorld.z)) * light(side, direct, open) + shine, 1.0);
}
)glsl";

inline constexpr const char* kPlainShader = R"glsl(#version 330 core
in vec3 vColour;
out vec4 result;
void main() { result = vec4(vColour, 1.0); }
)glsl";

inline constexpr const char* kNumberShader = R"glsl(#version 330 core
flat in int vBlock;
out int result;
void main() { result = vBlock; }
)glsl";

}  // namespace springtower
