// The camera. Pixels count from the frame's centre, x right and y down (row 0 of the frame buffer is
// the top of the picture).
uniform vec2 pixel_offset; // from this tile's pixels to the frame's, and to the sample in the pixel
uniform vec3 forward;
uniform vec3 step_x;
uniform vec3 step_y;

vec2 samplePoint() { return gl_FragCoord.xy + pixel_offset; }

// From the eye through the sample, not normalised.
vec3 viewRay() {
    vec2 p = samplePoint();
    return forward + p.x * step_x + p.y * step_y;
}
