// A reduction from n to m pixels a side (see resize.glsl). Defined as 0 or 1: SOURCE_IS_FRAME (what
// is read is the picture itself, to be exposed, of which the bright part is taken), EVEN (n = 2 m).
layout(binding = 0) uniform sampler2D fine;
uniform ivec2 n; // size of the whole fine picture
uniform ivec2 m;
uniform ivec2 fine_origin; // of the texture that holds a part of it
out vec4 color;

vec3 fetched(int x, int y) {
    vec3 c = texelFetch(fine, ivec2(x, y) - fine_origin, 0).rgb;
#if SOURCE_IS_FRAME
    c = brightPart(exposed(c));
#endif
    return c;
}

#if EVEN
vec3 reduced(ivec2 at) {
    const float weights[4] = float[](0.125, 0.375, 0.375, 0.125);
    int x[4];
    for (int k = 0; k < 4; ++k)
        x[k] = clamp(2 * at.x + k - 1, 0, n.x - 1); // the mirror image's pixel, too
    vec3 sum = vec3(0.0);
    for (int j = 0; j < 4; ++j) {
        int y = clamp(2 * at.y + j - 1, 0, n.y - 1);
        vec3 row = vec3(0.0);
        for (int i = 0; i < 4; ++i)
            row += weights[i] * fetched(x[i], y);
        sum += weights[j] * row;
    }
    return sum;
}
#else
// The first fine pixel that pixel i reads, and the place of its left edge from the tent's middle.
int readFrom(int i, int fine_edge, int made_edge, out float place) {
    int first = floorDivide((2 * i - 1) * fine_edge, 2 * made_edge);
    place = float(2 * (first * made_edge - i * fine_edge) - fine_edge) / float(2 * fine_edge);
    return first;
}

// As many as a tent touches; when halving exactly it begins and ends at edges.
int tapsOf(int fine_edge, int made_edge) {
    return fine_edge == 2 * made_edge ? 4 : int(ceil(float(2 * fine_edge) / float(made_edge))) + 1;
}

vec3 reduced(ivec2 at) {
    vec2 place, step = vec2(m) / vec2(n);
    ivec2 first = ivec2(readFrom(at.x, n.x, m.x, place.x), readFrom(at.y, n.y, m.y, place.y));
    ivec2 taps = ivec2(tapsOf(n.x, m.x), tapsOf(n.y, m.y));
    vec3 sum = vec3(0.0);
    float above = tentIntegral(place.y);
    for (int k = 0; k < taps.y; ++k) {
        float below = tentIntegral(place.y + float(k + 1) * step.y);
        int y = mirrored(first.y + k, n.y);
        vec3 row = vec3(0.0);
        float before = tentIntegral(place.x);
        for (int j = 0; j < taps.x; ++j) {
            float after = tentIntegral(place.x + float(j + 1) * step.x);
            row += (after - before) * fetched(mirrored(first.x + j, n.x), y);
            before = after;
        }
        sum += (below - above) * row;
        above = below;
    }
    return sum;
}
#endif

void main() { color = vec4(reduced(ivec2(gl_FragCoord.xy)), 1.0); }
