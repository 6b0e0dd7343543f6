// The ground that shows a shadow and nothing else (differential rendering, Debevec 1998): what is behind
// the object plus (ground with object - ground without). The ground is diffuse, so that the difference is
// -albedo / pi times the irradiance that the object keeps away. Without a known albedo it is taken to
// reflect as it looks: then the picture is scaled by the irradiance with over that without the object.
// Over nothing the shadow is alpha, with black, by the luminance of that ratio. Defined: GROUND_ALBEDO
// (known), GROUND_ALPHA (over nothing).
uniform vec3 eye;
uniform float ground_height;
uniform float ground_reach;     // from the eye; farther away no shadow is looked for
uniform vec3 ground_irradiance; // of all directional lights of the picture, without the object
#if GROUND_ALBEDO
uniform vec3 ground_albedo;
#endif
out vec4 color;

const float pi = 3.14159265358979;

void main() {
    vec4 picture = first_batch ? behind() : vec4(0.0);
    vec3 ray = viewRay(), kept = vec3(0.0), whole = ground_irradiance;
    float way = (ground_height - eye.y) / min(ray.y, -1e-30);
    if (ray.y < 0.0 && way * length(ray) < ground_reach) {
        vec3 p = eye + way * ray;
        p.y = ground_height;
        for (int i = 0; i < light_count; ++i) {
            vec3 irradiance;
            float distance;
            vec3 l = towards(i, p, irradiance, distance);
            irradiance *= max(l.y, 0.0);
#if LOCAL_LIGHTS
            if (lights[i].place.w > 0.0) whole += irradiance;
#endif
            kept += irradiance * (1.0 - visibilityOfGround(i, p, l, distance));
        }
    }
#if GROUND_ALPHA
    const vec3 luminance = vec3(0.2125, 0.7154, 0.0721);
    float light = dot(whole, luminance);
    if (light > 0.0) picture.a += dot(kept, luminance) / light;
#elif GROUND_ALBEDO
    picture.rgb -= ground_albedo / pi * kept;
#else
    picture.rgb -= behind().rgb * mix(vec3(0.0), kept / max(whole, 1e-30), greaterThan(whole, vec3(0.0)));
#endif
    color = picture;
}
