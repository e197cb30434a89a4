// A layer that keeps what it makes, and the pooled half of it for the level below.

#import shared/net_features
#import shared/net_layer
#import shared/net_pool
#import shared/net_single

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let corner = 2 * vec2<i32>(id.xy);
    if (!inside(corner)) {
        return;
    }
    let sums = activated_all(convolved(corner, id.z));
    store(corner, layer.first + id.z, sums);
    store_mean(corner, layer.first + id.z, sums);
}
