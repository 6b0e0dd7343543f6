// Adds one sample to the sum of the samples (by blending), scaled by a power of two so that the sum
// of large radiance stays finite and that of equal samples exact.
layout(binding = 0) uniform sampler2D samples;
uniform float weight;
out vec4 color;

void main() { color = weight * texelFetch(samples, ivec2(gl_FragCoord.xy), 0); }
