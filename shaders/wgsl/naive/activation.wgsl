// A leaky ReLU.

@group(0) @binding(0) var<uniform> layer: NaiveLayer;
@group(0) @binding(1) var<storage, read> source: array<f32>;
@group(0) @binding(2) var<storage, read_write> made: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < layer.width && id.y < layer.height) {
        let at = (id.z * layer.height + id.y) * layer.width + id.x;
        made[at] = select(source[at], layer.leak * source[at], source[at] < 0.0);
    }
}
