// Oren and Nayar 1994, the qualitative model (their equation 30, with A's 0.33): rough Lambertian facets
// whose slopes have the deviation sigma. With s = l.v - (n.l)(n.v) the sines and the azimuth's cosine are
// sin a tan b cos phi = s / max(n.l, n.v) where s > 0.
uniform float sigma; // degrees

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    float square = radians(sigma) * radians(sigma);
    float a = 1.0 - 0.5 * square / (square + 0.33), b = 0.45 * square / (square + 0.09);
    float nl = dot(n, l), nv = max(dot(n, v), 0.0);
    float s = max(dot(l, v) - nl * nv, 0.0);
    return albedo / 3.14159265358979 * (a + b * s / max(nl, nv));
}
