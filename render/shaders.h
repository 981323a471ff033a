#pragma once

/// The shaders of all renderers, in what GLSL 1.20 (OSMesa) and 3.30 (a window's core profile)
/// share. A prelude, which goes before each, has the words in which they differ.
namespace cloth::shaders {

constexpr char kVertex120[] = R"(#version 120
#define IN attribute
#define OUT varying
)";
constexpr char kFragment120[] = R"(#version 120
#define IN varying
#define COLOUR gl_FragColor
#define IN_SHADOW(map, place) shadow2D(map, place).r
)";
constexpr char kVertex330[] = R"(#version 330 core
#define IN in
#define OUT out
)";
constexpr char kFragment330[] = R"(#version 330 core
#define IN in
#define COLOUR colour_of_pixel
#define IN_SHADOW(map, place) texture(map, place)
out vec4 colour_of_pixel;
)";

/// Both passes of a mesh. `depth_offset` (m) changes the depth alone, never the place in the
/// picture.
constexpr char kMeshVertex[] = R"(
IN vec3 position;
IN vec3 normal;
uniform mat4 view;
uniform mat4 projection;
uniform mat4 world_to_shadow;
uniform float depth_offset;
OUT vec3 world;
OUT vec3 world_normal;
#ifdef VERTEX_COLOURS
IN vec3 colour;
OUT vec3 vertex_colour;
#endif
void main() {
    vec4 seen = view * vec4(position, 1.0);
    vec4 behind = projection * (seen - vec4(0.0, 0.0, depth_offset, 0.0));
    gl_Position = projection * seen;
    if (behind.w > 0.0) gl_Position.z = behind.z / behind.w * gl_Position.w;
    world = position;
    world_normal = normal;
#ifdef VERTEX_COLOURS
    vertex_colour = colour;
#endif
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
        sum += IN_SHADOW(shadow_map, p + away * vec3(cos(turn), sin(turn), 0.0));
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
IN vec3 world;
IN vec3 world_normal;
uniform vec3 eye;
uniform vec3 front_colour;
uniform vec3 back_colour;
uniform float gloss;
#ifdef VERTEX_COLOURS
IN vec3 vertex_colour;
uniform float coloured;  // 1: by its vertices' colours, 0: by the two above
#endif
void main() {
    vec3 n = normalize(gl_FrontFacing ? world_normal : -world_normal);
    vec3 base = gl_FrontFacing ? front_colour : back_colour;
#ifdef VERTEX_COLOURS
    base = mix(base, vertex_colour, coloured);
#endif
    vec3 to_eye = normalize(eye - world);
    float towards_key = max(dot(n, key), 0.0);
    float direct = towards_key > 0.0 ? towards_key * lit(world, n) : 0.0;
    float around = mix(ambient_ground, ambient_sky, 0.5 + 0.5 * n.y);
    float edge = 1.0 - max(dot(n, to_eye), 0.0);
    float rim = 0.12 * edge * edge * edge;
    float light = key_strength * direct + fill_strength * max(dot(n, fill), 0.0) + around + rim;
    float h2 = pow2(max(dot(n, normalize(key + to_eye)), 0.0));
    float highlight = gloss * direct * pow2(pow2(pow2(pow2(h2))));  // exponent 32
    COLOUR = vec4(shown(base * light + highlight), 1.0);
}
)";

constexpr char kGroundFragment[] = R"(
IN vec3 world;
IN vec3 world_normal;
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
    COLOUR = vec4(shown(mix(background, base * shade, clear)), 1.0);
}
)";

constexpr char kEmptyFragment[] = R"(
void main() {}
)";

}  // namespace cloth::shaders
