// A sphere, intersected as the unit sphere at the origin, to which the camera has been brought; the
// axes stay those of the world.
//
// With r the ray, d = r/|r| and e the eye, the ray's point nearest to the origin is
// m = e - (e.d) d = r x (e x r) / r.r, and the normal where it enters is n = m - sqrt(1 - m.m) d, of
// length 1 since m is perpendicular to d. e x r is linear in the pixel; its three coefficients come
// from the CPU in double, so that nothing cancels however far away the eye is.
uniform vec3 sphere_eye;
uniform vec3 moment_forward; // sphere_eye x forward
uniform vec3 moment_x;       // sphere_eye x step_x
uniform vec3 moment_y;       // sphere_eye x step_y
uniform float sphere_radius; // in the world
uniform vec3 sphere_centre;
uniform mat3 object_from_world;
layout(location = 0) out vec4 color;

// Texture coordinates as on a globe: u to the right seen from outside, the middle at +Z. u jumps at
// the seam, but u and u + 1/2 do not both jump at one place.
void readSphere(vec3 normal) {
    const float pi = 3.14159265358979;
    vec3 n = object_from_world * normal;
    float turn = atan(n.x, n.z) / (2.0 * pi);
    float u = 0.5 + turn, other = fract(1.0 + turn);
    vec2 uv = vec2(u, atan(length(n.xz), n.y) / pi);
    vec2 dx = dFdx(uv), dy = dFdy(uv);
    float other_x = dFdx(other), other_y = dFdy(other);
    dx.x = abs(other_x) < abs(dx.x) ? other_x : dx.x;
    dy.x = abs(other_y) < abs(dy.x) ? other_y : dy.x;
    readSurface(uv, dx, dy);
}

void main() {
    vec3 ray = viewRay();
    vec2 p = samplePoint();
    vec3 moment = moment_forward + p.x * moment_x + p.y * moment_y;
    vec3 nearest = cross(ray, moment) / dot(ray, ray);
    float square = 1.0 - dot(nearest, nearest);
    vec3 incident = normalize(ray);
    bool inside = dot(sphere_eye, sphere_eye) < 1.0;
    float half_chord = sqrt(max(square, 0.0));
    vec3 outward = nearest + (inside ? half_chord : -half_chord) * incident;
    readSphere(outward); // ahead of discard, for the changes from pixel to pixel
    if (square < 0.0 || (!inside && dot(sphere_eye, incident) > 0.0)) discard;
    // |ray| is the ray's length for a step of 1 along the view.
    float distance = (inside ? half_chord : -half_chord) - dot(sphere_eye, incident);
    surface_depth = sphere_radius * distance / length(ray);
    if (isMissing(surface_alpha)) discard;
    vec3 normal = inside ? -outward : outward;
    surface_outside = !inside;
    surface_point = sphere_centre + sphere_radius * outward;
    facet_normal = normal;
    vec3 radiance = shade(normal, incident);
    color = vec4(radiance + surface_emission, 1.0);
}
