// The ground that shows a shadow and nothing else (differential rendering, Debevec 1998): what is behind
// the object plus (ground with object - ground without). The ground is diffuse, so that the difference is
// -albedo / pi times the irradiance that the object keeps away. Without a known albedo it is taken to
// reflect as it looks: then the picture is scaled by the irradiance with over that without the object.
// Over nothing the shadow is alpha, with black, by the luminance of that ratio. Defined: GROUND_ALBEDO
// (known), GROUND_ALPHA (over nothing).
layout(binding = 9) uniform sampler2D kept; // from the ground, by this batch's lights
uniform vec3 ground_irradiance;             // of all directional lights, without the object
#if GROUND_ALBEDO
uniform vec3 ground_albedo;
#endif
out vec4 color;

void main() {
    vec4 picture = first_batch ? behind() : vec4(0.0);
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
#if GROUND_ALPHA
        const vec3 luminance = vec3(0.2125, 0.7154, 0.0721);
        float light = dot(whole, luminance);
        if (light > 0.0) picture.a += dot(lost, luminance) / light;
#elif GROUND_ALBEDO
        picture.rgb -= ground_albedo / 3.14159265358979 * lost;
#else
        vec3 share = lost / max(whole, 1e-30);
        picture.rgb -= behind().rgb * mix(vec3(0.0), share, greaterThan(whole, vec3(0.0)));
#endif
    }
    color = picture;
}
