// A perfect mirror. `shade` is what every material defines: the radiance towards the eye from a point
// with that unit normal, turned to the eye, seen along the unit vector `incident`.
vec3 shade(vec3 normal, vec3 incident) {
    return baseColor() * probeRadiance(reflect(incident, normal));
}
