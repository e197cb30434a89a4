// A grouped convolution, one output of one pixel an invocation.

@group(0) @binding(0) var<uniform> layer: NaiveLayer;
@group(0) @binding(1) var<storage, read> source: array<f32>;
@group(0) @binding(2) var<storage, read_write> made: array<f32>;
@group(0) @binding(3) var<storage, read> weights: array<f32>;
@group(0) @binding(4) var<storage, read> bias: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= layer.width || id.y >= layer.height) {
        return;
    }
    let radius = i32(layer.kernel / 2u);
    let first = id.z / layer.group_outputs * layer.group_inputs;
    var sum = bias[id.z];
    for (var input = 0u; input < layer.group_inputs; input++) {
        for (var ky = 0u; ky < layer.kernel; ky++) {
            for (var kx = 0u; kx < layer.kernel; kx++) {
                let at = vec2<i32>(id.xy) + vec2<i32>(vec2(kx, ky)) - radius;
                if (all(at >= vec2(0)) && at.x < i32(layer.width) && at.y < i32(layer.height)) {
                    let row = (first + input) * layer.height + u32(at.y);
                    let tap = ((id.z * layer.group_inputs + input) * layer.kernel + ky) * layer.kernel + kx;
                    sum += weights[tap] * source[row * layer.width + u32(at.x)];
                }
            }
        }
    }
    made[(id.z * layer.height + id.y) * layer.width + id.x] = sum;
}
