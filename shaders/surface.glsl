// What the object itself says of the point that is shaded: its parts' factors and textures. Surfaces
// call readSurface() ahead of shade(); materials ask for baseColor(), and multiply their metallic and
// roughness by surface_metallic and surface_roughness.
uniform vec3 base_color; // the material's
uniform vec3 part_color;
uniform vec3 part_emission;
uniform float part_alpha;
uniform float normal_scale;
layout(binding = 12) uniform sampler2D base_texture;
layout(binding = 13) uniform sampler2D metallic_roughness_texture;
layout(binding = 14) uniform sampler2D normal_texture;
layout(binding = 15) uniform sampler2D emissive_texture;
layout(binding = 20) uniform sampler2D alpha_texture;
uniform float base_premultiplied; // 1: the base texture's colours are multiplied by its alpha

vec3 surface_color, surface_emission;
float surface_metallic = 1.0, surface_roughness = 1.0;
float surface_alpha;
float surface_depth; // along the view
bool surface_outside; // whether the eye is on the outer side
// Where the surface is met, in the world, and its facet's unit normal, turned to the eye; set ahead of shade().
vec3 surface_point;
vec3 facet_normal;

// At a texture coordinate and its change from pixel to pixel.
void readSurface(vec2 uv, vec2 dx, vec2 dy) {
    surface_color = part_color;
    surface_emission = part_emission;
    surface_alpha = part_alpha;
#ifdef BASE_TEXTURE
    vec4 base = textureGrad(base_texture, uv, dx, dy);
    surface_color *= base.rgb / mix(1.0, max(base.a, 1e-30), base_premultiplied);
    surface_alpha *= base.a;
#endif
#ifdef ALPHA_TEXTURE
    surface_alpha *= textureGrad(alpha_texture, uv, dx, dy).r;
#endif
#ifdef METALLIC_ROUGHNESS_TEXTURE
    vec3 texel = textureGrad(metallic_roughness_texture, uv, dx, dy).rgb;
    surface_roughness = texel.g;
    surface_metallic = texel.b;
#endif
#ifdef EMISSIVE_TEXTURE
    surface_emission *= textureGrad(emissive_texture, uv, dx, dy).rgb;
#endif
}

vec3 baseColor() { return base_color * surface_color; }

// A normal bent by the normal texture. The tangent runs along u, square to the normal; y of the
// texture is upwards in its image, where v runs down. All follows from how position and coordinate
// change from pixel to pixel (Schueler 2013), so that no tangents are stored.
vec3 bentNormal(vec3 normal, vec3 position, vec2 uv, vec2 dx, vec2 dy) {
#ifdef NORMAL_TEXTURE
    vec3 px = dFdx(position), py = dFdy(position);
    vec3 across = cross(py, normal) * dx.x + cross(normal, px) * dy.x;
    vec3 down = cross(py, normal) * dx.y + cross(normal, px) * dy.y;
    float hand = dot(cross(px, py), normal) < 0.0 ? -1.0 : 1.0;
    if (dot(across, across) == 0.0) return normal;
    across = hand * normalize(across);
    vec3 up = cross(normal, across);
    up = hand * dot(up, down) > 0.0 ? -up : up;
    vec3 texel = 2.0 * textureGrad(normal_texture, uv, dx, dy).xyz - 1.0;
    vec3 bent = normal_scale * (texel.x * across + texel.y * up) + texel.z * normal;
    return dot(bent, bent) > 0.0 ? normalize(bent) : normal;
#else
    return normal;
#endif
}
