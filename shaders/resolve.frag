// From the sum of the samples to the picture: mean, exposure, tone map and, for bytes, the sRGB
// transfer function. Colours are premultiplied by alpha; curves apply to the straight colour.
// Defined as 0 or 1: STRAIGHT (alpha may be below 1), SCURVE, BYTES.
layout(binding = 0) uniform sampler2D samples;
uniform float sum_weight; // of all samples
uniform float exposure;   // factor
uniform float scurve_n;
uniform float scurve_sigma;
out vec4 color;

const float largest = 3.4028235e38;

// c^n / (c^n + sigma^n), so written that c^n cannot overflow.
float scurve(float c) { return c > 0.0 ? 1.0 / (1.0 + pow(scurve_sigma / c, scurve_n)) : 0.0; }

float srgb(float c) {
    return c <= 0.0031308 ? 12.92 * c : 1.055 * pow(min(c, 1.0), 1.0 / 2.4) - 0.055;
}

void main() {
    vec4 mean = texelFetch(samples, ivec2(gl_FragCoord.xy), 0) / sum_weight;
    float alpha = mean.a;
    vec3 c = clamp(mean.rgb * exposure, -largest, largest);
#if STRAIGHT
    c = alpha > 0.0 ? c / alpha : vec3(0.0);
#endif
#if SCURVE
    c = vec3(scurve(c.r), scurve(c.g), scurve(c.b));
#endif
#if BYTES
    color = vec4(srgb(c.r), srgb(c.g), srgb(c.b), alpha); // PNG has straight alpha
#elif STRAIGHT
    color = vec4(alpha * c, alpha);
#else
    color = vec4(c, alpha);
#endif
}
