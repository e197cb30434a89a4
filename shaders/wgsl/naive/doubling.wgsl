// Twice the size by bilinear interpolation between pixel centres, the edge continued outwards; the frame is the doubled
// one.

@group(0) @binding(0) var<uniform> layer: NaiveLayer;
@group(0) @binding(1) var<storage, read> source: array<f32>;
@group(0) @binding(2) var<storage, read_write> made: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= layer.width || id.y >= layer.height) {
        return;
    }
    let size = vec2(layer.width, layer.height) / 2u;
    let near = vec2<i32>(id.xy / 2u);
    let side = select(vec2(-1), vec2(1), id.xy % 2u == vec2(1u));
    let far = clamp(near + side, vec2(0), vec2<i32>(size) - 1);
    let upper = (id.z * size.y + u32(near.y)) * size.x;
    let lower = (id.z * size.y + u32(far.y)) * size.x;
    let near_row = 0.75 * source[upper + u32(near.x)] + 0.25 * source[upper + u32(far.x)];
    let far_row = 0.75 * source[lower + u32(near.x)] + 0.25 * source[lower + u32(far.x)];
    made[(id.z * layer.height + id.y) * layer.width + id.x] = 0.75 * near_row + 0.25 * far_row;
}
