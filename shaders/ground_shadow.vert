// For each shadow map of the sample's lights the part of the ground that it covers: what the light sees
// through the corners of the map. A corner's ray runs from A (depth 0) to B (depth 1); with g the height above the ground it meets
// it at (gA B - gB A) / (gA - gB), kept homogeneous, so that rays which rise (w <= 0) are clipped.
uniform mat4 clip_from_world;
uniform float ground_height;
uniform vec2 map_size;
out vec3 place; // in the map, texels times w, and w: linear in p
flat out vec4 light_place, light_strength, light_axis, light_maps;
flat out int layer;

void main() {
#if LOCAL_LIGHTS
    layer = gl_InstanceID;
    Light light = lights[int(views[layer].light.x)];
#else
    Light light = lights[gl_InstanceID];
    layer = int(light.maps.x);
#endif
    View view = views[layer];
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * map_size;
    // Six maps overlap by their margins, kMargin of render/shadow_views.cpp.
    if (light.maps.y > 1.0) corner = clamp(corner, vec2(2.0), map_size - 2.0);
    vec4 a = corner.x * view.world_from_map[0] + corner.y * view.world_from_map[1] + view.world_from_map[3];
    vec4 b = a + view.world_from_map[2];
    a /= a.w;
    b /= b.w;
    vec4 p = (a.y - ground_height) * b - (b.y - ground_height) * a;
    place = vec3(corner, 1.0) * (view.map_from_world * p).w;
    light_place = light.place;
    light_strength = light.strength;
    light_axis = light.axis;
    light_maps = light.maps;
    gl_ClipDistance[0] = p.w;
    gl_Position = clip_from_world * p;
    gl_Position.z = 0.0; // no near or far plane
}
