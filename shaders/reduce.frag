// A reduction from n to m pixels a side (see resize.glsl). Defined as 0 or 1: SOURCE_IS_FRAME (what is
// read is the picture itself, to be exposed, of which the bright part is taken).
layout(binding = 0) uniform sampler2D fine;
uniform ivec2 n; // size of the whole fine picture
uniform ivec2 m;
uniform ivec2 fine_origin; // of the texture that holds a part of it
out vec4 color;

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

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec2 place, step = vec2(m) / vec2(n);
    ivec2 first = ivec2(readFrom(at.x, n.x, m.x, place.x), readFrom(at.y, n.y, m.y, place.y));
    ivec2 taps = ivec2(tapsOf(n.x, m.x), tapsOf(n.y, m.y));
    vec3 sum = vec3(0.0);
    float above = tentIntegral(place.y);
    for (int k = 0; k < taps.y; ++k) {
        float below = tentIntegral(place.y + float(k + 1) * step.y);
        int y = mirrored(first.y + k, n.y) - fine_origin.y;
        vec3 row = vec3(0.0);
        float before = tentIntegral(place.x);
        for (int j = 0; j < taps.x; ++j) {
            float after = tentIntegral(place.x + float(j + 1) * step.x);
            vec3 c = texelFetch(fine, ivec2(mirrored(first.x + j, n.x) - fine_origin.x, y), 0).rgb;
#if SOURCE_IS_FRAME
            c = brightPart(exposed(c));
#endif
            row += (after - before) * c;
            before = after;
        }
        sum += (below - above) * row;
        above = below;
    }
    color = vec4(sum, 1.0);
}
