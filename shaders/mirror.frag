// A perfect mirror. `shade` is what every material defines: the radiance towards the eye from a point
// with that unit normal, turned to the eye, seen along the unit vector `incident`.
uniform vec3 base_color;

vec3 shade(vec3 normal, vec3 incident) {
    return base_color * probeRadiance(reflect(incident, normal));
}
