// Light that a coarser grid hands to a finer one: in the cells along the finer one's border all that goes
// through them in all iterations, before the first: render/src/lpv/cascade.rs.

#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lattice
#import shared/lpv_lobe
#import shared/lpv_medium
#import uniforms/light_grid
#import uniforms/medium_record
#constant FACTORS = 0
#constant SCATTERED = 1
#constant STEADY = 1
#constant UNSCATTERED = 2

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> outside: LightGrid;
@group(0) @binding(2) var<uniform> medium: MediumRecord;
// [cells, 3]: as media.wgsl writes it
@group(0) @binding(3) var<storage, read> media: array<vec4f>;
// [2 SCATTERED + 1, 3, cells] of the coarser grid: as the medium and as surfaces show it, and the first kind
@group(0) @binding(4) var<storage, read> shown: array<vec4f>;
// [kinds, 3, cells]: lobes; then, if there is scattered light, [cells]: what is sent out again
@group(0) @binding(5) var<storage, read_write> state: array<vec4f>;
// [sides, 3, cells]: flux and energy of steady light
@group(0) @binding(6) var<storage, read_write> source: array<vec4f>;

// The shortest way, cells: of light that is hardly there.
const LEAST_WAY = 1e-6;

// Fluence of light of a cell over the energy that arrives there, as if as much went through the cells beside
// it; `again` is 0 but for scattered light.
fn way_of(handed: vec4f, within: f32, extinction: f32, again: f32) -> f32 {
    let energies = by_kind(lobe(handed.xyz, handed.w)) / max(handed.w, 1e-37);
    var way = 0.0;
    var collides = 0.0;
    var out = 0.0;
    var again_in = 0.0;
    for (var kind = 0u; kind < 3u; kind++) {
        let leaves = leaving(vec3f(within), kind).x;
        let count = COUNTS[kind] * SHARES[kind];
        collides += energies[kind] * (1.0 - leaves);
        if FACTORS == PLACED {
            let halfway = 0.5 * DISTANCES[kind];
            let enters = exp(-(extinction - within) * DISTANCES[kind]);
            let in_cell = leaves * track(vec3f(enters), vec3f(extinction), halfway).x;
            way += energies[kind] * in_cell;
            again_in += count * in_cell;
            out += count * track(vec3f(leaves), vec3f(extinction), halfway).x;
        }
    }
    var out_again = out;
    if FACTORS != PLACED {
        out = track(mean_leaving(vec3f(within)), vec3f(extinction), dot(COUNTS * SHARES, DISTANCES)).x;
        out_again = 0.0;
    }
    return max(way + out + again * collides * (out_again + again_in), LEAST_WAY);
}

// Light of a kind in a cell of the coarser grid.
fn of_kind(light: u32, at: u32) -> vec4f {
    let plane = 3u * u32(outside.size.w);
    if STEADY == 1u && KINDS > 1u {
        let all = shown[at];
        let along = abs(all.xyz);
        var axis = select(2u, 1u, along.y >= along.z);
        if along.x >= along.y && along.x >= along.z {
            axis = 0u;
        }
        return select(vec4f(0.0), all, light == 2u * axis + select(0u, 1u, all[axis] < 0.0));
    }
    if light + 1u == KINDS {
        return shown[SCATTERED * plane + at];
    }
    if light == 0u {
        return shown[2u * plane + at];
    }
    return shown[at] - shown[plane + at];
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
    let own = media[3u * id.x];
    let extinction = reduced_extinction() * own.w * grid.low.w;
    let area = grid.low.w * grid.low.w / (outside.low.w * outside.low.w);
    var again = vec3f(0.0);
    for (var light = 0u; light < KINDS; light++) {
        for (var c = 0u; c < 3u; c++) {
            var arrived = vec4f(0.0);
            if inside {
                let handed = of_kind(light, c * u32(outside.size.w) + around) * area;
                let sets_out = select(0.0, media[3u * id.x + 1u][c], light == UNSCATTERED);
                // Bands may show less than nothing.
                let is_light = handed.w > 0.0;
                arrived = select(vec4f(0.0), handed / way_of(handed, own[c], extinction[c], sets_out), is_light);
            }
            let made = lobe(arrived.xyz, arrived.w);
            if STEADY == 1u {
                source[lobe_index(light, c, id.x)] = arrived;
            }
            state[lobe_index(light, c, id.x)] = made;
            if SCATTERED == 1u {
                again[c] += colliding(made, own.rgb, c);
            }
        }
    }
    if SCATTERED == 1u {
        state[again_index(id.x)] = vec4f(again * media[3u * id.x + 1u].rgb, 0.0);
    }
}
