// A picture of the frame's own size, pixel for pixel.
layout(binding = 2) uniform sampler2D image;
uniform ivec2 tile_origin;

vec3 behind() { return texelFetch(image, tile_origin + ivec2(gl_FragCoord.xy), 0).rgb; }
