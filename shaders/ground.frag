// The ground that shows a shadow and nothing else (differential rendering, Debevec 1998): what is
// behind the object plus (ground with object - ground without). The ground is diffuse, so that of
// its radiance albedo E / pi, E the irradiance without the object, the share D / E is lost of which
// the object keeps D away. What is behind may be darker than albedo E / pi, where the ground in the
// picture has a smaller albedo or already stands in shadow: then the difference would be more than
// there is, and the picture itself loses that share (the relative error of the same paper). The two
// agree where they meet, and the choice is the same in and out of the shadow, so neither draws an
// edge. Without a known albedo it is always the latter. Alpha is the luminance of D / E, whatever is
// behind; over nothing the shadow is that, with black. Defined: GROUND_ALBEDO (known).
layout(binding = 9) uniform sampler2D kept; // from the ground, by this batch's lights
uniform vec3 ground_irradiance;             // of all directional lights, without the object
#if GROUND_ALBEDO
uniform vec3 ground_albedo;
#endif
out vec4 color;

void main() {
    vec3 picture = first_batch ? behind() : vec3(0.0);
    float alpha = 0.0;
    vec3 ray = viewRay();
    if (ray.y < 0.0) {
        vec3 lost = texelFetch(kept, ivec2(gl_FragCoord.xy), 0).rgb, whole = ground_irradiance;
#if LOCAL_LIGHTS
        vec3 p = groundPoint(ray);
        for (int i = 0; i < light_count; ++i) {
            vec3 irradiance;
            float distance;
            vec3 l = towards(lights[i], p, irradiance, distance);
            if (lights[i].place.w > 0.0) whole += irradiance * max(l.y, 0.0);
        }
#endif
        const vec3 luminance = vec3(0.2125, 0.7154, 0.0721);
        float light = dot(whole, luminance);
        if (light > 0.0) alpha = dot(lost, luminance) / light;
        vec3 radiance = behind(); // of which the share is lost
#if GROUND_ALBEDO
        radiance = min(radiance, ground_albedo / 3.14159265358979 * whole);
#endif
        vec3 share = lost / max(whole, 1e-30);
        picture -= radiance * mix(vec3(0.0), share, greaterThan(whole, vec3(0.0)));
    }
    color = vec4(picture, alpha);
}
