// Two images one after the other, channels in an order of their own.

@group(0) @binding(0) var<uniform> layer: NaiveLayer;
@group(0) @binding(1) var<storage, read> coarse: array<f32>;
@group(0) @binding(2) var<storage, read_write> made: array<f32>;
@group(0) @binding(3) var<storage, read> skip: array<f32>;
// For each channel that is made, which of the plain concatenation it is.
@group(0) @binding(4) var<storage, read> order: array<u32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= layer.width || id.y >= layer.height) {
        return;
    }
    let at = (id.z * layer.height + id.y) * layer.width + id.x;
    let pixel = id.y * layer.width + id.x;
    let plane = layer.height * layer.width;
    let channel = order[id.z];
    if (channel < layer.coarse) {
        made[at] = coarse[channel * plane + pixel];
    } else {
        made[at] = skip[(channel - layer.coarse) * plane + pixel];
    }
}
