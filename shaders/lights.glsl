// A batch of the scene's lights and what of them reaches a point. Defined: LIGHT_CAPACITY; LOCAL_LIGHTS,
// whether point and spot lights are among them; SHADOW_MAPS, whether the object casts its shadow by maps.
// Without maps it is the unit sphere at the origin.
struct Light {
    vec4 place;    // unit, towards the light (w = 0); or its position (w = 1)
    vec4 strength; // irradiance of a surface that faces the light; or intensity
    vec4 axis;     // of a spot: where it shines; w: scale of its cone
    vec4 maps;     // first layer, number of layers, a texel's side, offset of the cone
};
struct View {
    mat4 map_from_world;
    vec4 world_from_map[3]; // rows x, y, z of the inverse, as row vectors multiply
};
layout(std140, binding = 0) uniform Lights { Light lights[LIGHT_CAPACITY]; };
layout(std140, binding = 1) uniform Views { View views[LIGHT_CAPACITY]; };
layout(binding = 8) uniform sampler2DArray shadow_maps;
uniform int light_count;
uniform bool first_batch; // light that is not of the lights belongs to the first batch

// Towards light i from p, unit; `irradiance` is that of a surface there that faces it, and `distance`
// how far the light is, where that counts.
vec3 towards(int i, vec3 p, out vec3 irradiance, out float distance) {
    irradiance = lights[i].strength.rgb;
    distance = 1.0;
    vec3 l = lights[i].place.xyz;
#if LOCAL_LIGHTS
    if (lights[i].place.w > 0.0) {
        vec3 q = l - p;
        distance = max(length(q), 1e-18);
        l = q / distance;
        float cone = clamp(lights[i].axis.w * -dot(l, lights[i].axis.xyz) + lights[i].maps.w, 0.0, 1.0);
        irradiance *= cone * cone / (distance * distance);
    }
#endif
    return l;
}

#if SHADOW_MAPS

int layerOf(int i, vec3 p) {
    int layer = int(lights[i].maps.x);
#if LOCAL_LIGHTS
    if (lights[i].maps.y > 1.0) { // six, +X -X +Y -Y +Z -Z
        vec3 q = p - lights[i].place.xyz, a = abs(q);
        int axis = a.x >= a.y && a.x >= a.z ? 0 : (a.y >= a.z ? 1 : 2);
        layer += 2 * axis + (q[axis] < 0.0 ? 1 : 0);
    }
#endif
    return layer;
}

// Where p lies in a layer: texels and depth. Behind a light nothing is.
bool project(int layer, vec3 p, out vec3 place) {
    vec4 m = views[layer].map_from_world * vec4(p, 1.0);
#if LOCAL_LIGHTS
    if (m.w <= 0.0) return false;
    place = m.xyz / m.w;
#else
    place = m.xyz;
#endif
    return true;
}

// The four texels about a point, in the order of textureGather, and their bilinear weights.
vec4 texelsAbout(int layer, vec2 place, out vec4 weights, out vec2 corner) {
    corner = floor(place - 0.5) + 1.0; // where the four meet: any rounding gathers the same ones
    vec2 f = place - corner + 0.5;
    weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y));
    return textureGather(shadow_maps, vec3(corner / vec2(textureSize(shadow_maps, 0).xy), float(layer)));
}

// Part of light i that the object leaves to its own point p on a facet with the normal `facet`.
//
// A texel stores what a light sees at its centre, and p's facet is elsewhere there: on the facet's
// plane, in whose depth at the texel the comparison is made (Isidoro 2006, receiver plane). World
// planes (n, -n.p) multiply world_from_map to those of the map, where depth is linear on a plane also in
// perspective. What is left are facets next to the one that p is on, when the object is round: on
// them the plane is off by less than a texel's side, by which p moves out of the surface and towards
// the light. Beyond a slope of 16 the facet is all but edge-on and the plane of no use.
float visibilityOfObject(int i, vec3 p, vec3 facet, vec3 to_light, float distance) {
    float texel = lights[i].maps.z * distance;
    p += texel * (facet + to_light);
    int layer = layerOf(i, p);
    vec3 place;
    if (!project(layer, p, place)) return 1.0;
    vec4 weights;
    vec2 corner;
    vec4 stored = texelsAbout(layer, place.xy, weights, corner);
    vec4 plane = vec4(facet, -dot(facet, p));
    vec3 n = vec3(dot(plane, views[layer].world_from_map[0]), dot(plane, views[layer].world_from_map[1]),
                  dot(plane, views[layer].world_from_map[2]));
    vec2 slope = n.z != 0.0 ? -n.xy / n.z : vec2(0.0);
    float c = abs(dot(facet, to_light));
    slope *= min(1.0, 16.0 * c * inversesqrt(max(1.0 - c * c, 1e-6)));
    vec2 d = corner - 0.5 - place.xy;
    vec4 depth = place.z + vec4(dot(slope, d + vec2(0, 1)), dot(slope, d + vec2(1, 1)),
                                dot(slope, d + vec2(1, 0)), dot(slope, d));
    return dot(weights, vec4(lessThanEqual(depth, stored)));
}

// The same of a point on the ground, which no map holds: whatever is there stands before it.
float visibilityOfGround(int i, vec3 p, vec3 to_light, float distance) {
    int layer = layerOf(i, p);
    vec3 place;
    if (!project(layer, p, place)) return 1.0;
    vec4 weights;
    vec2 corner;
    vec4 stored = texelsAbout(layer, place.xy, weights, corner);
    return dot(weights, vec4(equal(stored, vec4(1.0))));
}

#else

// A convex body hides no light from facets that face it.
float visibilityOfObject(int i, vec3 p, vec3 facet, vec3 to_light, float distance) { return 1.0; }

// Whether the way to the light misses the sphere, which it passes at the distance |p x l|.
float visibilityOfGround(int i, vec3 p, vec3 to_light, float distance) {
    vec3 moment = cross(p, to_light);
    float square = 1.0 - dot(moment, moment), ahead = -dot(p, to_light);
    if (square <= 0.0 || ahead <= 0.0) return 1.0;
#if LOCAL_LIGHTS
    if (lights[i].place.w > 0.0 && ahead - sqrt(square) >= distance) return 1.0;
#endif
    return 0.0;
}

#endif
