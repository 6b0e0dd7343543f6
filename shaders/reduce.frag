// A reduction along one axis, from n to m pixels (see resize.glsl). Defined as 0 or 1: SOURCE_IS_FRAME
// (what is read is the picture itself, to be exposed, of which the bright part is taken), EVEN (n = 2 m).
layout(binding = 0) uniform sampler2D fine;
uniform ivec2 axis; // (1, 0) or (0, 1)
uniform int n;      // the whole picture's size along it
uniform int m;
uniform ivec2 fine_origin; // where the first pixel of the texture stands in the whole
uniform ivec2 made_origin; // and that of the target
out vec4 color;

vec3 fetched(ivec2 at) {
    vec3 c = texelFetch(fine, at - fine_origin, 0).rgb;
#if SOURCE_IS_FRAME
    c = brightPart(exposed(c));
#endif
    return c;
}

#if EVEN
vec3 reduced(ivec2 line, int i) {
    const float weights[4] = float[](0.125, 0.375, 0.375, 0.125);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 4; ++k) // clamped is the mirror image's pixel, too
        sum += weights[k] * fetched(line + clamp(2 * i + k - 1, 0, n - 1) * axis);
    return sum;
}
#else
vec3 reduced(ivec2 line, int i) {
    // The first fine pixel that the tent touches, and the place of its left edge from the middle.
    int first = floorDivide((2 * i - 1) * n, 2 * m);
    float place = float(2 * (first * m - i * n) - n) / float(2 * n), step = float(m) / float(n);
    // As many as a tent touches; when halving exactly it begins and ends at edges.
    int taps = n == 2 * m ? 4 : int(ceil(float(2 * n) / float(m))) + 1;
    vec3 sum = vec3(0.0);
    float before = tentIntegral(place);
    for (int k = 0; k < taps; ++k) {
        float after = tentIntegral(place + float(k + 1) * step);
        sum += (after - before) * fetched(line + mirrored(first + k, n) * axis);
        before = after;
    }
    return sum;
}
#endif

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy) + made_origin;
    color = vec4(reduced(at * axis.yx, at.x * axis.x + at.y * axis.y), 1.0);
}
