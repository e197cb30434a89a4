// Multiplies and adds: eight vectors of four sums, none of which waits for another, TURNS times.

#constant TURNS = 256

@group(0) @binding(0) var<storage, read_write> made: array<vec4<f32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let factor = vec4(0.999) - 1e-9 * vec4<f32>(f32(id.x));
    let term = vec4(1e-3, 2e-3, 3e-3, 4e-3);
    var a = mat4x4<f32>(term, 2.0 * term, 3.0 * term, 4.0 * term);
    var b = mat4x4<f32>(5.0 * term, 6.0 * term, 7.0 * term, 8.0 * term);
    for (var i = 0u; i < TURNS; i++) {
        a = mat4x4<f32>(
            fma(a[0], factor, term), fma(a[1], factor, term), fma(a[2], factor, term), fma(a[3], factor, term),
        );
        b = mat4x4<f32>(
            fma(b[0], factor, term), fma(b[1], factor, term), fma(b[2], factor, term), fma(b[3], factor, term),
        );
    }
    made[id.x] = a[0] + a[1] + a[2] + a[3] + b[0] + b[1] + b[2] + b[3];
}
