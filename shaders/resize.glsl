// From a picture of n pixels a side to one of m <= n and back, by tents of the coarse pixels' width
// integrated over the fine pixels; outside, the picture is its own mirror image.
//
// With F the integral of the tent, coarse pixel i takes fine pixel j by the weight
//     w(i, j) = F((j + 1) m / n - i - 1/2) - F(j m / n - i - 1/2),
// and the way back is its transpose, n / m w. Tents sum to 1 everywhere, so every fine pixel is taken
// by m / n in all and every coarse one gives n / m: flat pictures stay flat and no energy is lost, at
// odd sizes and at the borders. Places are differences of integers, so they stay exact however large
// the picture is. For n = 2 m the weights are 1 3 3 1 / 8, whose repetition tends to smooth splines.

float tentIntegral(float u) {
    u = clamp(u, -1.0, 1.0);
    float rest = 1.0 - abs(u);
    return u < 0.0 ? 0.5 * rest * rest : 1.0 - 0.5 * rest * rest;
}

int mirrored(int i, int n) {
    i = i < 0 ? -1 - i : i;
    return clamp(i >= n ? 2 * n - 1 - i : i, 0, n - 1);
}

// floor(a / b) for b > 0. A float's quotient is off by one at most.
int floorDivide(int a, int b) {
    int q = int(floor(float(a) / float(b)));
    int rest = a - q * b;
    return rest < 0 ? q - 1 : (rest >= b ? q + 1 : q);
}

// The first of the three coarse pixels whose tents touch fine pixel j, and their weights.
ivec4 enlargedFrom(int j, int n, int m, out vec3 weights) {
    int first = floorDivide(2 * j * m - n, 2 * n);
    float place = float(2 * (j * m - first * n) - n) / float(2 * n), step = float(m) / float(n);
    for (int k = 0; k < 3; ++k) {
        weights[k] = (tentIntegral(place + step - float(k)) - tentIntegral(place - float(k))) / step;
    }
    return ivec4(mirrored(first, m), mirrored(first + 1, m), mirrored(first + 2, m), first);
}

// What pixel `at` of a picture of `size` gets from the coarse picture.
vec3 enlarged(sampler2D coarse, ivec2 at, ivec2 size) {
    ivec2 m = textureSize(coarse, 0);
    vec3 wx, wy;
    ivec4 x = enlargedFrom(at.x, size.x, m.x, wx), y = enlargedFrom(at.y, size.y, m.y, wy);
    vec3 sum = vec3(0.0);
    for (int j = 0; j < 3; ++j) {
        sum += wy[j] * (wx[0] * texelFetch(coarse, ivec2(x[0], y[j]), 0).rgb +
                        wx[1] * texelFetch(coarse, ivec2(x[1], y[j]), 0).rgb +
                        wx[2] * texelFetch(coarse, ivec2(x[2], y[j]), 0).rgb);
    }
    return sum;
}

// The same where the coarse picture is exactly half as large: 3/4 and 1/4 along each axis, which is
// linear between its pixels.
vec3 enlargedTwice(sampler2D coarse, ivec2 at, ivec2 size) {
    return texture(coarse, (vec2(at) + 0.5) / vec2(size)).rgb;
}
