// What a panorama holds in a direction, bilinear between texel centres. `border` is OpenEXR's rule:
// the outer texel centres lie on the face edges, or on poles and seam.

// Cube faces: the sampler is seamless. By the border rule texel i of N stands at 2i/(N - 1) - 1
// instead of (2i + 1)/N - 1: what lies at s by the one lies at s (N - 1)/N by the other.
vec3 lookUp(samplerCube faces, bool border, vec3 d) {
    if (border) {
        float edge = float(textureSize(faces, 0).x);
        vec3 a = abs(d);
        float major = max(a.x, max(a.y, a.z));
        d *= mix(vec3((edge - 1.0) / edge), vec3(1.0), equal(a, vec3(major)));
    }
    return textureLod(faces, d, 0.0).rgb;
}

// Lat-long: the texture's first and last row are the poles, each one colour. The weights are computed
// here and the four texels fetched, because filtering hardware keeps eight bits of a weight.
// acos(d.y) would be off by up to 1.6e-4 rad, and by far more next to the poles.
vec3 lookUp(sampler2D latlong, bool border, vec3 d) {
    const float pi = 3.14159265358979;
    ivec2 size = textureSize(latlong, 0);
    float across = length(d.xz);
    float phi = across > 0.0 ? atan(d.x, d.z) : 0.0;
    float u = 0.5 - phi / (2.0 * pi), v = atan(across, d.y) / pi;

    float x, y;
    if (border) {
        x = u * float(size.x);
        y = v * float(size.y - 1);
    } else {
        // Rows are a step apart, and the outer ones half a step from the poles.
        float rows = float(size.y - 2), row = v * rows;
        x = u * float(size.x) - 0.5;
        y = row < 0.5 ? 2.0 * row : (row > rows - 0.5 ? rows + 1.0 - 2.0 * (rows - row) : row + 0.5);
    }
    float left = floor(x), top = clamp(floor(y), 0.0, float(max(size.y - 2, 0)));
    int x0 = int(left), x1 = x0 + 1, y0 = int(top), y1 = min(y0 + 1, size.y - 1);
    x0 = x0 < 0 ? x0 + size.x : (x0 >= size.x ? x0 - size.x : x0);
    x1 = x1 >= size.x ? x1 - size.x : x1;
    vec3 a = texelFetch(latlong, ivec2(x0, y0), 0).rgb, b = texelFetch(latlong, ivec2(x1, y0), 0).rgb;
    vec3 c = texelFetch(latlong, ivec2(x0, y1), 0).rgb, e = texelFetch(latlong, ivec2(x1, y1), 0).rgb;
    return mix(mix(a, b, x - left), mix(c, e, x - left), clamp(y - top, 0.0, 1.0));
}
