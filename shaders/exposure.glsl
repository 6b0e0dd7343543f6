// From radiance to exposed values, and which part of them a lens scatters.
uniform float exposure;  // factor
uniform float threshold; // of luminance; 0: all of it is scattered

const float largest = 3.4028235e38;

// Finite whatever comes in: NaN is 0, what floats cannot hold the largest that they can.
vec3 exposed(vec3 c) {
    return mix(clamp(c * exposure, -largest, largest), vec3(0.0), isnan(c));
}

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Grows smoothly from 0 at half the threshold to 1 at one and a half.
float brightShare(vec3 c) {
    return threshold > 0.0 ? smoothstep(0.5 * threshold, 1.5 * threshold, luminance(c)) : 1.0;
}

vec3 brightPart(vec3 c) { return brightShare(c) * c; }
