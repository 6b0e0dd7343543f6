// One surround's part of the sum of retinex.glsl; parts add up by blending.
layout(binding = 0) uniform sampler2D coarse;
uniform ivec2 size; // of the picture that is made
uniform float eps;
uniform float weight;
out vec4 color;

void main() {
    vec3 blurred = enlarged(coarse, ivec2(gl_FragCoord.xy), size);
    color = vec4(weight * log(max(blurred, vec3(0.0)) + eps), 1.0);
}
