// Means of 2x2 pixels; the frame is that of the means.

@group(0) @binding(0) var<uniform> layer: NaiveLayer;
@group(0) @binding(1) var<storage, read> source: array<f32>;
@group(0) @binding(2) var<storage, read_write> made: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < layer.width && id.y < layer.height) {
        let at = (2u * (id.z * layer.height + id.y) * 2u * layer.width) + 2u * id.x;
        let below = at + 2u * layer.width;
        let mean = 0.25 * (source[at] + source[at + 1u] + source[below] + source[below + 1u]);
        made[(id.z * layer.height + id.y) * layer.width + id.x] = mean;
    }
}
