// From the sum of the samples to their mean. Colours are premultiplied by alpha.
layout(binding = 0) uniform sampler2D samples;
uniform float sum_weight; // of all samples
out vec4 color;

const float largest = 3.4028235e38;

void main() {
    vec4 sum = texelFetch(samples, ivec2(gl_FragCoord.xy), 0);
    vec4 mean = sum / sum_weight;
    // A mean of the largest may round to infinity; what a sample made infinite or NaN stays that.
    bvec3 broken = bvec3(uvec3(isinf(sum.rgb)) | uvec3(isnan(sum.rgb)));
    color = vec4(mix(clamp(mean.rgb, -largest, largest), sum.rgb, broken), mean.a);
}
