// The layer that makes the image of the network.

#import shared/net_image
#import shared/net_layer

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let corner = 2 * vec2<i32>(id.xy);
    if (!inside(corner)) {
        return;
    }
    let sums = convolved(corner, id.z);
    store(corner, layer.first + id.z, sums);
}
