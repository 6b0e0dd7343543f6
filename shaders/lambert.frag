// A Lambertian surface of that albedo under lights. `brdf` is what every lit material defines: for
// unit vectors, the normal n, l towards the light (n.l > 0) and v towards the eye, reflected radiance
// over irradiance.

vec3 brdf(vec3 n, vec3 l, vec3 v) { return albedo / 3.14159265358979; }
