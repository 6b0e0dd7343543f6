// Dodging and burning (Reinhard et al. 2002, eq. 5 to 9): the luminance x becomes x / (1 + V(s)), s the
// largest scale at which centre V(s) and surround V(s + 1) still agree,
//     |V(s) - V(s + 1)| / (2^phi key / s^2 + V(s)) < local-contrast.
// As in the authors' own program, V is a pyramid of Gaussians (Burt and Adelson 1983) whose level k
// has a sample at every 2^k th pixel, bilinear between them, and s grows from 1 to 43 over eight
// levels. Outside, the picture's border goes on; in that program it is black there, which brightens
// the border. Level k >= 1 is mip level k - 1 of `levels`, with a margin of 2^(8-k) samples; level 0
// is the picture.
layout(binding = 2) uniform sampler2D levels;
uniform float key;

float localLuminance(ivec2 at, int level) {
    ivec2 low = at >> level;
    vec2 t = vec2(at - (low << level)) / float(1 << level);
    low += 256 >> level;
    ivec2 high = low + 1;
    float a = texelFetch(levels, low, level - 1).r;
    float b = texelFetch(levels, ivec2(high.x, low.y), level - 1).r;
    float c = texelFetch(levels, ivec2(low.x, high.y), level - 1).r;
    float d = texelFetch(levels, high, level - 1).r;
    return mix(mix(a, b, t.x), mix(c, d, t.x), t.y);
}

vec3 reinhardLocalTone(vec3 c) {
    c = clamp(c, 0.0, 1e30);
    float centre = luminance(c);
    for (int level = 0; level < 7; ++level) {
        float s = exp(float(level) / 8.0 * log(43.0));
        float surround = localLuminance(framePixel(), level + 1);
        if (abs(centre - surround) > parameters[1] * (exp2(parameters[0]) * key / (s * s) + centre)) {
            break;
        }
        centre = surround;
    }
    return c / (1.0 + centre);
}
