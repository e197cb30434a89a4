// A reflective shadow map (Dachsbacher and Stamminger 2005): where one light's rays meet the scene, and the
// power that each texel's surface reflects diffusely. Planes [9, height, width]: position in world space,
// normal, flux in watts.

#import shared/lights
#import shared/seen
#import shared/view
#import uniforms/light_record

/// Which light `frame/reflective` is of.
struct Chosen {
    /// Its index.
    light: u32,
}

@group(0) @binding(6) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(7) var<storage, read> pictures: array<u32>;
@group(0) @binding(8) var<uniform> which: Chosen;
@group(0) @binding(9) var<storage, read_write> texels: array<f32>;

// What a texel's rays cover: of a light at a place the solid angle, of one infinitely far away the area.
fn extent(pixel: vec2f) -> f32 {
    let size = vec2f(2.0 / (view.scale_x * f32(view.width)), 2.0 / (view.scale_y * f32(view.height)));
    if view.perspective == 0u {
        return size.x * size.y;
    }
    let at = view_position(pixel, 1.0, view);
    let distance = length(at);
    return size.x * size.y / (distance * distance * distance);
}

@compute @workgroup_size(TILE, TILE)
fn reflect_light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let seen = seen_at(id.xy);
    var point = vec3f(0.0);
    var flux = vec3f(0.0);
    if seen.valid {
        point = view.eye.xyz + seen.offset;
        let light = lights[which.light];
        let arrived = arrival(light, point);
        // Irradiance times squared distance is intensity; of a light infinitely far away it stays what it is.
        let spread = select(1.0, arrived.distance * arrived.distance, arrived.distance > 0.0);
        flux = arrived.irradiance * spread * extent(vec2f(id.xy) + 0.5) * seen.diffuse;
    }
    let pixels = view.width * view.height;
    let index = id.y * view.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        texels[index + c * pixels] = point[c];
        texels[index + (3u + c) * pixels] = seen.normal[c];
        texels[index + (6u + c) * pixels] = flux[c];
    }
}
