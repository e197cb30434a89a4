// Light that surfaces send, before the first iteration; nothing is shown yet.

#import shared/lpv_fixed
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lobe
#import uniforms/light_grid
#constant SCATTERED = 1
#constant UNSCATTERED = 2

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [kinds, 3, cells]: lobes; then what begin.wgsl writes
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [1 + SCATTERED, 3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;
// [kinds]: by how much to multiply what an iteration shows
@group(0) @binding(5) var<storage, read_write> weights: array<vec4f>;

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    if id.x < KINDS {
        weights[id.x] = vec4f(1.0);
    }
    for (var c = 0u; c < 3u; c++) {
        let first = 12u * id.x + 4u * c;
        let face = grid.low.w * grid.low.w;
        let flux = face * vec3f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u));
        let sent = vec4f(flux, face * fixed_sum(first + 3u));
        state[lobe_index(0u, c, id.x)] = lobe(sent.xyz, sent.w);
        for (var light = 1u; light < UNSCATTERED; light++) {
            state[lobe_index(light, c, id.x)] = vec4f(0.0);
        }
        for (var plane = 0u; plane <= SCATTERED; plane++) {
            shown[lobe_index(plane, c, id.x)] = vec4f(0.0);
        }
    }
}
