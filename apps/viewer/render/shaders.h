#pragma once

namespace springtower {

// OpenGL 3.3 core. `inFace` and `halfFace` are metres on a face, so that edges can be darkened by the same width on all of them:
// gaps and contacts then read as lines.

inline constexpr const char* kVertexShader = R"glsl(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 inFace;
layout(location = 3) in vec2 halfFace;
layout(location = 4) in vec3 colour;
layout(location = 5) in int block;
uniform mat4 clipFromWorld;
uniform mat4 lightFromWorld;
out vec3 vWorld;
out vec3 vNormal;
out vec2 vInFace;
out vec2 vHalf;
out vec3 vColour;
out vec4 vLight;
flat out int vBlock;
void main() {
  vWorld = position;
  vNormal = normal;
  vInFace = inFace;
  vHalf = halfFace;
  vColour = colour;
  vLight = lightFromWorld * vec4(position + 0.0006 * normal, 1.0);
  vBlock = block;
  gl_Position = clipFromWorld * vec4(position, 1.0);
}
)glsl";

inline constexpr const char* kShadeShader = R"glsl(#version 330 core
in vec3 vWorld;
in vec3 vNormal;
in vec2 vInFace;
in vec2 vHalf;
in vec3 vColour;
in vec4 vLight;
flat in int vBlock;
uniform sampler2DShadow shadow;
uniform vec3 toLight;
uniform vec3 background;
uniform vec3 eye;
uniform int highlighted;
uniform vec2 floorMiddle;
uniform float floorRadius;
out vec4 result;

float sunlit() {
  vec3 at = 0.5 * vLight.xyz + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float size = 1.0 / float(textureSize(shadow, 0).x);
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) {
    vec2 off = (vec2(float(i % 3), float(i / 3)) - 1.0) * 1.6 * size;
    sum += texture(shadow, vec3(at.xy + off, at.z - 0.0006));
  }
  return sum / 9.0;
}

void main() {
  vec3 n = normalize(vNormal);
  float sun = max(dot(n, toLight), 0.0) * sunlit();
  float sky = 0.5 + 0.5 * n.z;
  float fill = max(dot(n, vec3(0.8, 0.5, 0.33)), 0.0);  // weak light from the other side
  if (vBlock < 0) {  // the floor: a grid of 2 cm, every fifth line stronger, that fades out
    vec2 from = vWorld.xy;
    vec2 width = max(fwidth(from), vec2(1e-6));
    vec2 fine = abs(fract(from / 0.02 - 0.5) - 0.5) * 0.02 / width;
    vec2 strong = abs(fract(from / 0.1 - 0.5) - 0.5) * 0.1 / width;
    float far = clamp(1.0 - max(width.x, width.y) / 0.008, 0.0, 1.0);
    float lines = max(0.07 * (1.0 - min(min(fine.x, fine.y), 1.0)) * far, 0.16 * (1.0 - min(min(strong.x, strong.y), 1.0)));
    vec3 base = vec3(0.90, 0.90, 0.89) * mix(0.66, 1.0, sunlit());
    float fade = smoothstep(0.15, 0.75, length(from - floorMiddle) / floorRadius);
    result = vec4(mix(base * (1.0 - lines), background, fade), 1.0);
    return;
  }
  vec2 toEdge = vHalf - abs(vInFace);
  float edge = min(toEdge.x, toEdge.y);
  float line = max(0.0004, 0.6 * length(fwidth(vInFace)));
  float bevel = mix(0.55, 1.0, smoothstep(0.0, line, edge)) * mix(0.88, 1.0, smoothstep(0.0, 0.003, edge));
  // Long grain, another phase on each block.
  float grain = sin(900.0 * vInFace.y + 3.0 * sin(40.0 * vInFace.x + float(vBlock)) + 1.7 * float(vBlock));
  vec3 colour = vColour * (1.0 + 0.03 * grain) * (highlighted == vBlock ? 1.18 : 1.0);
  float shine = pow(max(dot(n, normalize(toLight + normalize(eye - vWorld))), 0.0), 40.0) * 0.08 * sun;
  result = vec4(colour * bevel * (0.30 * sky + 0.36 + 0.14 * fill + 0.58 * sun) + shine, 1.0);
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
