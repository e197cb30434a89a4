// The gathered layers over the sharp picture: a pixel takes them from those gathered pixels around that are
// blurred alike, and stays what it is as far as it is in focus and nothing in front spreads over it. The
// plain version is render/src/methods/ring_gather/reference.rs.

#import shared/picture
#import shared/ring_gather

@group(0) @binding(5) var<storage, read> low: array<vec4f>;
@group(0) @binding(6) var<storage, read> behind: array<vec4f>;
@group(0) @binding(7) var<storage, read> before: array<vec4f>;
@group(0) @binding(8) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn combine(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= gather.width || id.y >= gather.height {
        return;
    }
    let pixels = gather.width * gather.height;
    let index = id.y * gather.width + id.x;
    let radius = circle(index);
    let place = (vec2f(id.xy) + 0.5) / f32(gather.scale) - 0.5;
    let corner = floor(place);
    var back = vec3f(0.0);
    var front = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let at = corner + vec2f(f32(i & 1u), f32(i >> 1u));
        let shares = 1.0 - abs(place - at);
        let inside = clamp(vec2i(at), vec2i(0), vec2i(i32(gather.low_width), i32(gather.low_height)) - 1);
        let from_low = u32(inside.y) * gather.low_width + u32(inside.x);
        let weight = shares.x * shares.y / (0.25 + abs(low[from_low].w - radius));
        back += weight * behind[from_low].xyz;
        front += weight * before[from_low];
        weights += weight;
    }
    let sharp = picture_light(index, pixels);
    let blurred = saturate((abs(radius) - gather.sharp) / (gather.blurred - gather.sharp));
    let own = sharp + (back / weights - sharp) * blurred;
    let over = front / weights;
    let mixed = over.xyz + (1.0 - over.w) * own;
    image[index] = mixed.x;
    image[index + pixels] = mixed.y;
    image[index + 2u * pixels] = mixed.z;
}
