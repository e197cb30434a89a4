// Light that surfaces reflect, before the first iteration; nothing is shown yet.

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [kinds, 3, cells]: lobes
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [1 + SCATTERED + FIRST, 3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    for (var c = 0u; c < 3u; c++) {
        let first = 12u * id.x + 4u * c;
        let face = grid.low.w * grid.low.w;
        let flux = face * vec3f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u));
        state[lobe_index(0u, c, id.x)] = lobe(flux, face * fixed_sum(first + 3u));
        for (var light = 1u; light < UNSCATTERED; light++) {
            state[lobe_index(light, c, id.x)] = vec4f(0.0);
        }
        for (var plane = 0u; plane <= SCATTERED + FIRST; plane++) {
            shown[lobe_index(plane, c, id.x)] = vec4f(0.0);
        }
    }
}
