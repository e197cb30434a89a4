// The picture in the pixels that are gathered, each with the signed radius of its circle of confusion:
// negative in front of the plane in focus. Of several pixels that become one, the nearest gives the radius,
// and those like it the colour. The plain version is render/src/methods/ring_gather/reference.rs.

#import shared/picture
#import shared/ring_gather

// Radiance and radius, pixels of the image.
@group(0) @binding(5) var<storage, read_write> low: array<vec4f>;

@compute @workgroup_size(TILE, TILE)
fn shrink(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= gather.low_width || id.y >= gather.low_height {
        return;
    }
    let first = id.xy * gather.scale;
    let end = min(first + gather.scale, vec2u(gather.width, gather.height));
    var radius = gather.largest;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            radius = min(radius, circle(y * gather.width + x));
        }
    }
    var light = vec3f(0.0);
    var weights = 0.0;
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let index = y * gather.width + x;
            let weight = max(1.0 - (circle(index) - radius) / gather.softness, 0.0);
            light += weight * picture_light(index, gather.width * gather.height);
            weights += weight;
        }
    }
    low[id.y * gather.low_width + id.x] = vec4f(light / weights, radius);
}
