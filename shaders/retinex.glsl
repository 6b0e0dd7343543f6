// Multi-scale Retinex (Rahman, Jobson and Woodell 1996), a channel:
//     exp(sum_n w_n (ln(x + eps) - k ln(blur_n(x) + eps))) = (x + eps) exp(-k sum_n w_n ln(blur_n + eps))
// The sum, smooth as it is, comes from half the size.
layout(binding = 2) uniform sampler2D surrounds;

vec3 retinexTone(vec3 c) {
#if EVEN
    vec3 sum = enlargedTwice(surrounds, framePixel(), frame_size);
#else
    vec3 sum = enlarged(surrounds, framePixel(), frame_size);
#endif
    return (clamp(c, 0.0, 1e30) + parameters[2]) * exp(-parameters[0] * sum);
}
