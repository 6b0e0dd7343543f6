// The irradiance that the object keeps from the ground, of one light.
in vec3 place;
flat in vec4 light_place, light_strength, light_axis, light_maps;
flat in int layer;
out vec4 color;

void main() {
    vec3 p = groundPoint(viewRay()), irradiance;
    float distance;
    vec3 l = towards(Light(light_place, light_strength, light_axis, light_maps), p, irradiance, distance);
#if SHADOW_MAPS
    float visible = visibilityOfGround(layer, place.xy / place.z);
#else
    float visible = visibilityOfGround(p, l, light_place.w > 0.0 ? distance : 3.4e38);
#endif
    color = vec4(irradiance * (max(l.y, 0.0) * (1.0 - visible)), 0.0);
}
