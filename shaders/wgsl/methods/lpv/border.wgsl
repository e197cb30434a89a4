// Light that a coarser grid hands to a finer one: in the cells along the finer one's border all that goes
// through them in all iterations, before the first: render/src/lpv/cascade.rs. There is no medium.

#import shared/lpv_grid
#import shared/lpv_lattice
#import shared/lpv_lobe
#import uniforms/light_grid
#constant FACTORS = 0

const PLACED = 0u;

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> outside: LightGrid;
// [3, cells] of the coarser grid
@group(0) @binding(2) var<storage, read> shown: array<vec4f>;
// [3, cells]: lobes
@group(0) @binding(3) var<storage, read_write> state: array<vec4f>;

// Fluence of light of a cell over the energy that arrives there, as if as much went through the cells beside
// it.
fn way_of(handed: vec4f) -> f32 {
    if FACTORS != PLACED {
        return dot(COUNTS * SHARES, DISTANCES);
    }
    return 0.5 * dot(by_kind(lobe(handed.xyz, handed.w)) / max(handed.w, 1e-37) + COUNTS * SHARES, DISTANCES);
}

@compute @workgroup_size(64)
fn enter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() || !is_border(cell_at(id.x)) {
        return;
    }
    let middle = grid.low.xyz + grid.low.w * (vec3f(cell_at(id.x)) + 0.5);
    let there = vec3i(floor((middle - outside.low.xyz) / outside.low.w));
    let size = vec3i(outside.size.xyz);
    let inside = all(there >= vec3i(0)) && all(there < size);
    let around = u32((there.z * size.y + there.y) * size.x + there.x);
    let area = grid.low.w * grid.low.w / (outside.low.w * outside.low.w);
    for (var c = 0u; c < 3u; c++) {
        var arrived = vec4f(0.0);
        if inside {
            let handed = shown[c * u32(outside.size.w) + around] * area;
            // Bands may show less than nothing.
            arrived = select(vec4f(0.0), handed / way_of(handed), handed.w > 0.0);
        }
        state[c * u32(grid.size.w) + id.x] = lobe(arrived.xyz, arrived.w);
    }
}
