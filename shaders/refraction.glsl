// The way of a ray through the object: refracted where it meets it, and again where it leaves.

// What the first face mirrors. From inside, the object's is the denser side.
float firstReflectance(vec3 normal, vec3 incident, float ior) {
    return surfaceReflectance(clamp(-dot(normal, incident), 0.0, 1.0),
                              surface_outside ? ior : 1.0 / ior);
}

// Where the ray leaves with the outward normal `normal`: refracted, or, where it cannot, mirrored
// once and taken to leave so.
vec3 leaving(vec3 inside, vec3 normal, float ior) {
    vec3 facing = dot(inside, normal) > 0.0 ? -normal : normal;
    vec3 refracted = refract(inside, facing, ior);
    return dot(refracted, refracted) > 0.0 ? refracted : reflect(inside, facing);
}

#ifdef OBJECT_IS_SPHERE
// A sphere: exact. From the point n of the unit sphere the chord along t ends at n - 2 (n.t) t, which
// is the normal there.
vec3 farNormal(vec3 normal, vec3 inside) { return normal - 2.0 * dot(normal, inside) * inside; }
#else
// A mesh: by depth and normals of what looks away from the eye, as the frame sees it (Wyman 2005).
// He guesses the length of the way inside from two thicknesses; here the ray is followed through
// the picture until it comes out behind the far side, or beside it, by steps and bisection.
layout(binding = 19) uniform sampler2D far_side; // outward normal; depth along the view, 0: none
uniform mat4 clip_from_world;
uniform float object_extent; // nothing in the object is longer

const int steps = 24, bisections = 7;

vec3 farSidePoint(vec3 position) { // texture coordinates and depth
    vec4 clip = clip_from_world * vec4(position, 1.0);
    return vec3(0.5 + 0.5 * clip.xy / clip.w, clip.w);
}

bool insideObject(vec3 position) {
    vec3 p = farSidePoint(position);
    if (any(lessThan(p.xy, vec2(0.0))) || any(greaterThanEqual(p.xy, vec2(1.0)))) return false;
    return p.z < texelFetch(far_side, ivec2(p.xy * textureSize(far_side, 0)), 0).w;
}

// Bilinear over those of the four texels that hold something; the zero vector where none does.
vec3 farSideNormal(vec3 position) {
    vec2 at = farSidePoint(position).xy * textureSize(far_side, 0) - 0.5;
    ivec2 corner = ivec2(floor(at)), last = textureSize(far_side, 0) - 1;
    vec2 part = at - floor(at);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 step = ivec2(k & 1, k >> 1);
        vec4 texel = texelFetch(far_side, clamp(corner + step, ivec2(0), last), 0);
        vec2 weight = mix(1.0 - part, part, vec2(step));
        if (texel.w > 0.0) sum += (weight.x * weight.y + 1e-6) * texel.xyz;
    }
    return dot(sum, sum) > 0.0 ? normalize(sum) : vec3(0.0);
}

vec3 farNormal(vec3 normal, vec3 inside) {
    float from = 0.0, to = object_extent;
    for (int i = 1; i <= steps; ++i) {
        float length_inside = object_extent * float(i) / float(steps);
        if (!insideObject(surface_point + length_inside * inside)) {
            to = length_inside;
            break;
        }
        from = length_inside;
    }
    for (int i = 0; i < bisections; ++i) {
        float middle = 0.5 * (from + to);
        if (insideObject(surface_point + middle * inside)) {
            from = middle;
        } else {
            to = middle;
        }
    }
    return farSideNormal(surface_point + from * inside);
}
#endif

// The direction in which the ray goes on beyond the object. Where the object has no far side, as a
// single pane, it is not bent.
vec3 throughObject(vec3 normal, vec3 incident, float ior) {
    if (!surface_outside) return leaving(incident, normal, ior);
    vec3 inside = refract(incident, normal, 1.0 / ior);
    vec3 last = farNormal(normal, inside);
    return dot(last, last) > 0.0 ? leaving(inside, last, ior) : incident;
}

// The radiance that comes through the object, of weight 1, where the first face mirrors `mirrored`.
#ifdef OBJECT_IS_SPHERE
// Inside a sphere a ray meets the surface at one angle for ever, so that each time F is mirrored
// and 1 - F leaves: (1 - F) F^k after k reflections, 1 altogether. Each reflection turns the ray
// that leaves by pi - 2 theta, theta the angle inside, in the plane of incidence; so does the first
// that leaves follow on what the first face mirrors. A rotation has d_{k+1} = 2 cos(pi - 2 theta)
// d_k - d_{k-1}. What is left after the last exit leaves there: with four, the sphere is 0.23 % from
// a path tracer's (Cycles, builtin:sky), with three 0.25, two 1.4, one 10; more change nothing but
// the outline.
const int exits = 4;

vec3 radianceThrough(vec3 normal, vec3 incident, float ior, float mirrored) {
    vec3 direction = throughObject(normal, incident, ior);
    if (!surface_outside) return probeRadiance(direction);
    float c = dot(normal, incident);
    float turn = 2.0 * (1.0 - c * c) / (ior * ior) - 1.0; // -cos(2 theta) = 2 sin^2 theta - 1
    vec3 before = reflect(incident, normal), sum = vec3(0.0);
    float left = 1.0;
    for (int k = 1; k < exits; ++k) {
        sum += left * (1.0 - mirrored) * probeRadiance(direction);
        left *= mirrored;
        vec3 next = 2.0 * turn * direction - before;
        before = direction;
        direction = next;
    }
    return sum + left * probeRadiance(direction);
}
#else
vec3 radianceThrough(vec3 normal, vec3 incident, float ior, float mirrored) {
    return probeRadiance(throughObject(normal, incident, ior));
}
#endif
