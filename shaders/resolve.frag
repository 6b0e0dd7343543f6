// From the sum of the samples to their mean. Colours are premultiplied by alpha. KEEP_POSITIVE: a ground
// that loses more light than it has is black.
layout(binding = 0) uniform sampler2D samples;
uniform float sum_weight; // of all samples
out vec4 color;

const float largest = 3.4028235e38;

void main() {
    vec4 mean = texelFetch(samples, ivec2(gl_FragCoord.xy), 0) / sum_weight;
#if KEEP_POSITIVE
    mean.rgb = max(mean.rgb, 0.0);
#endif
    color = vec4(clamp(mean.rgb, -largest, largest), mean.a);
}
