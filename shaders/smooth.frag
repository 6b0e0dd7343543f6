// A level smoothed across, for enlarge.frag.
layout(binding = 0) uniform sampler2D level;
out vec4 color;

void main() {
    color = vec4(smoothed(level, ivec2(gl_FragCoord.xy), ivec2(1, 0), textureSize(level, 0)), 1.0);
}
