#pragma once

namespace cloth::shaders {

/// Both passes of a mesh. `depth_offset` (m) changes the depth alone, never the place in the
/// picture.
constexpr char kMeshVertex[] = R"(#version 120
attribute vec3 position;
attribute vec3 normal;
uniform mat4 view;
uniform mat4 projection;
uniform mat4 world_to_shadow;
uniform float depth_offset;
varying vec3 world;
varying vec3 world_normal;
void main() {
    vec4 seen = view * vec4(position, 1.0);
    vec4 behind = projection * (seen - vec4(0.0, 0.0, depth_offset, 0.0));
    gl_Position = projection * seen;
    if (behind.w > 0.0) gl_Position.z = behind.z / behind.w * gl_Position.w;
    world = position;
    world_normal = normal;
}
)";

/// How much of the key light arrives at a point: percentage-closer filtering (Reeves et al. 1987)
/// with the normal offset of Holbert 2011 against self-shadowing.
constexpr char kShadowFunction[] = R"(
uniform sampler2DShadow shadow_map;
uniform mat4 world_to_shadow;
uniform float shadow_texel;      // (m)
uniform float shadow_step;       // one texel in the coordinates of the map
uniform float shadow_strength;   // 0 without shadows
float lit(vec3 point, vec3 n) {
    vec3 p = (world_to_shadow * vec4(point + 2.0 * shadow_texel * n, 1.0)).xyz;
    if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThan(p.xy, vec2(1.0)))) return 1.0;
    float sum = 0.0;
    for (int i = 0; i < SHADOW_TAPS; ++i) {
        float turn = 2.39996 * float(i);
        float away = SHADOW_BLUR * shadow_step * sqrt((float(i) + 0.5) / float(SHADOW_TAPS));
        sum += shadow2D(shadow_map, p + away * vec3(cos(turn), sin(turn), 0.0)).r;
    }
    return mix(1.0, sum / float(SHADOW_TAPS), shadow_strength);
}
uniform vec3 key;
uniform vec3 fill;
uniform float key_strength;
uniform float fill_strength;
uniform float ambient_sky;
uniform float ambient_ground;
// A square root stands for the exponent 1 / 2.2 of sRGB: the eye does not tell, software does.
vec3 shown(vec3 linear) { return sqrt(clamp(linear, 0.0, 1.0)); }
)";

constexpr char kMeshFragment[] = R"(
float pow2(float x) { return x * x; }
varying vec3 world;
varying vec3 world_normal;
uniform vec3 eye;
uniform vec3 front_colour;
uniform vec3 back_colour;
uniform float gloss;
void main() {
    vec3 n = normalize(gl_FrontFacing ? world_normal : -world_normal);
    vec3 base = gl_FrontFacing ? front_colour : back_colour;
    vec3 to_eye = normalize(eye - world);
    float towards_key = max(dot(n, key), 0.0);
    float direct = towards_key > 0.0 ? towards_key * lit(world, n) : 0.0;
    float around = mix(ambient_ground, ambient_sky, 0.5 + 0.5 * n.y);
    float edge = 1.0 - max(dot(n, to_eye), 0.0);
    float rim = 0.12 * edge * edge * edge;
    float light = key_strength * direct + fill_strength * max(dot(n, fill), 0.0) + around + rim;
    float h2 = pow2(max(dot(n, normalize(key + to_eye)), 0.0));
    float highlight = gloss * direct * pow2(pow2(pow2(pow2(h2))));  // exponent 32
    gl_FragColor = vec4(shown(base * light + highlight), 1.0);
}
)";

constexpr char kGroundFragment[] = R"(
varying vec3 world;
varying vec3 world_normal;
uniform vec3 centre;
uniform float radius;
uniform float grid;
uniform vec3 front_colour;
uniform vec3 line_colour;
uniform vec3 background;
void main() {
    vec2 cell = world.xz / grid;
    vec2 away = abs(fract(cell - 0.5) - 0.5) / max(fwidth(cell), vec2(1e-6));
    float line = 1.0 - clamp(min(away.x, away.y) - 0.5, 0.0, 1.0);
    vec3 base = mix(front_colour, line_colour, line);
    float clear = 1.0 - smoothstep(0.25, 1.0, length(world.xz - centre.xz) / radius);
    vec3 n = vec3(0.0, 1.0, 0.0);
    float shade = mix(0.45, 1.0, lit(world, n));
    gl_FragColor = vec4(shown(mix(background, base * shade, clear)), 1.0);
}
)";

constexpr char kEmptyFragment[] = R"(#version 120
void main() {}
)";

}  // namespace cloth::shaders
