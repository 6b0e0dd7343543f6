// What of the lights of shaders/light_blocks.glsl reaches a point.
layout(binding = 8) uniform sampler2DArray shadow_maps;
uniform int light_count;
vec3 albedo; // of the point that is lit
uniform vec2 texel_jitter; // of the sample, -0.5 to 0.5
uniform bool first_batch; // light that is not of the lights belongs to the first batch

// Towards a light from p, unit; `irradiance` is that of a surface there that faces it, and `distance`
// how far the light is, where that counts.
vec3 towards(Light light, vec3 p, out vec3 irradiance, out float distance) {
    irradiance = light.strength.rgb;
    distance = 1.0;
    vec3 l = light.place.xyz;
#if LOCAL_LIGHTS
    if (light.place.w > 0.0) {
        vec3 q = l - p;
        distance = max(length(q), 1e-18);
        l = q / distance;
        float cone = clamp(light.axis.w * -dot(l, light.axis.xyz) + light.maps.w, 0.0, 1.0);
        irradiance *= cone * cone / (distance * distance);
    }
#endif
    return l;
}

#if SHADOW_MAPS

// Directional lights have a map each.
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

// The texel at a place that is moved by the sample's share of a texel: the mean over the samples is what
// bilinear weights of the four texels about the place would give.
ivec2 texelAt(vec2 place) {
    return clamp(ivec2(floor(place + texel_jitter)), ivec2(0), textureSize(shadow_maps, 0).xy - 1);
}

// Change of depth a texel on a plane with that normal through p. World planes (n, -n.p) multiply
// world_from_map to those of the map, where depth is linear on a plane, also in perspective. Beyond a
// slope of 16 the plane is all but edge-on and of no use.
vec2 depthSlope(int layer, vec3 p, vec3 normal, vec3 to_light) {
    float c = dot(normal, to_light);
    float limit = min(1.0, 16.0 * abs(c) * inversesqrt(max(1.0 - c * c, 1e-6)));
#if LOCAL_LIGHTS
    vec4 plane = vec4(normal, -dot(normal, p));
    vec3 n = vec3(dot(plane, views[layer].world_from_map[0]), dot(plane, views[layer].world_from_map[1]),
                  dot(plane, views[layer].world_from_map[2]));
    return n.z != 0.0 ? -limit / n.z * n.xy : vec2(0.0);
#else
    // With u = k_u X.p and depth -k_z l.p: d(depth)/du = (n.X / k_u) / (n.l / k_z).
    mat4 m = views[layer].map_from_world;
    vec2 across = vec2(dot(normal, vec3(m[0].x, m[1].x, m[2].x)), dot(normal, vec3(m[0].y, m[1].y, m[2].y)));
    return c != 0.0 ? limit / c * across * views[layer].light.yz : vec2(0.0);
#endif
}

// Part of light i that the object leaves to its own point p on a facet with the normal `facet`.
//
// A texel stores what a light sees at its centre, and p's facet is elsewhere there: on the facet's
// plane, in whose depth at the texel the comparison is made (Isidoro 2006, receiver plane). What is left
// are facets next to the one that p is on, when the object is round: on them the plane is off by less
// than a texel's side, by which p moves out of the surface and towards the light.
float visibilityOfObject(int i, vec3 p, vec3 facet, vec3 to_light, float distance) {
    float texel = lights[i].maps.z * distance;
    p += texel * (facet + to_light);
    int layer = layerOf(i, p);
    vec3 place;
    if (!project(layer, p, place)) return 1.0;
    ivec2 at = texelAt(place.xy);
    float depth = place.z + dot(depthSlope(layer, p, facet, to_light), vec2(at) + 0.5 - place.xy);
    return depth <= texelFetch(shadow_maps, ivec3(at, layer), 0).x ? 1.0 : 0.0;
}

// Part of a light that the object leaves to the ground, at a place of a map. No map holds the ground:
// whatever is there stands before it.
float visibilityOfGround(int layer, vec2 place) {
    return texelFetch(shadow_maps, ivec3(texelAt(place), layer), 0).x == 1.0 ? 1.0 : 0.0;
}

#else

uniform vec3 caster_centre; // of the sphere
uniform float caster_radius;

// A convex body hides no light from facets that face it.
float visibilityOfObject(int i, vec3 p, vec3 facet, vec3 to_light, float distance) { return 1.0; }

// Whether the way to the light misses the sphere, which it passes at the distance |p x l|.
float visibilityOfGround(vec3 p, vec3 to_light, float distance) {
    p = (p - caster_centre) / caster_radius;
    distance /= caster_radius;
    vec3 moment = cross(p, to_light);
    float square = 1.0 - dot(moment, moment), ahead = -dot(p, to_light);
    return square > 0.0 && ahead > 0.0 && ahead - sqrt(square) < distance ? 0.0 : 1.0;
}

#endif
