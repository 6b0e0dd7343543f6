// The unit sphere at the origin, intersected.
//
// With r the ray, d = r/|r| and e the eye, the ray's point nearest to the origin is
// m = e - (e.d) d = r x (e x r) / r.r, and the normal where it enters is n = m - sqrt(1 - m.m) d, of
// length 1 since m is perpendicular to d. e x r is linear in the pixel; its three coefficients come
// from the CPU in double, so that nothing cancels however far away the eye is.
uniform vec3 eye;
uniform vec3 moment_forward; // eye x forward
uniform vec3 moment_x;       // eye x step_x
uniform vec3 moment_y;       // eye x step_y
out vec4 color;

void main() {
    vec3 ray = viewRay();
    vec2 p = samplePoint();
    vec3 moment = moment_forward + p.x * moment_x + p.y * moment_y;
    vec3 nearest = cross(ray, moment) / dot(ray, ray);
    float square = 1.0 - dot(nearest, nearest);
    vec3 incident = normalize(ray);
    bool inside = dot(eye, eye) < 1.0;
    if (square < 0.0 || (!inside && dot(eye, incident) > 0.0)) discard;
    float half_chord = sqrt(square);
    vec3 normal = inside ? -(nearest + half_chord * incident) : nearest - half_chord * incident;
    surface_point = inside ? -normal : normal;
    facet_normal = normal;
    color = vec4(shade(normal, incident), 1.0);
}
