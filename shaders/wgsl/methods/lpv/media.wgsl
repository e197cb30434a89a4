// What the medium in each cell does to light that sets out from it: render/src/lpv/flight.rs.

#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_lattice
#import shared/lpv_medium
#import shared/lpv_part
#import shared/medium
#import uniforms/light_grid
#import uniforms/medium_record
#constant FACTORS = 0

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<storage, read> table: array<f32>;
// [cells, 3]: of each colour extinction on the part of the way to a neighbour that lies in the cell, per
// distance of one cell, and, last, density; what sets out again of light that collides on its way out; what
// sets out in all of even light where nothing is absorbed, over fluence.
@group(0) @binding(2) var<storage, read_write> media: array<vec4f>;
@group(0) @binding(3) var<uniform> medium: MediumRecord;
@group(0) @binding(4) var densities: texture_3d<f32>;

const FIRST = -6.0;
const PER_DOUBLING = 4.0;
const ENTRIES = 129u;
// What leaves a cell of any medium at least.
const LEAST = 1e-20;

// What sets out of even light where nothing is absorbed, over fluence.
fn even_rate(within: vec3f, extinction: vec3f) -> vec3f {
    let sets_out = 1.0 / max(mean_leaving(within), vec3f(LEAST));
    var way = vec3f(0.0);
    for (var kind = 0u; kind < 3u; kind++) {
        let leaves = leaving(within, kind);
        let enters = exp(-(extinction - within) * DISTANCES[kind]);
        let middle = 0.5 * DISTANCES[kind];
        let of_kind = track(leaves, extinction, middle) + leaves * track(enters, extinction, middle);
        way += COUNTS[kind] * SHARES[kind] * of_kind;
    }
    return sets_out / max(sets_out * way, vec3f(0.999 * dot(COUNTS * SHARES, DISTANCES)));
}

// The share of the way to a neighbour that lies in the cell.
fn own_share(extinction: f32) -> f32 {
    let at = clamp((log2(max(extinction, 1e-30)) - FIRST) * PER_DOUBLING, 0.0, f32(ENTRIES - 1u));
    let low = min(u32(at), ENTRIES - 2u);
    return mix(table[low], table[low + 1u], at - f32(low));
}

// Mean density of a cell.
fn density_of(at: vec3i) -> f32 {
    let part = part_in_medium(at);
    var sum = 0.0;
    for (var i = 0; i < 8; i++) {
        sum += density_inside(part_point(part, i));
    }
    return sum / 8.0 * share_of(part);
}

@compute @workgroup_size(64)
fn fill(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    let density = density_of(cell_at(id.x));
    let extinction = reduced_extinction() * density * grid.low.w;
    var within = extinction;
    if FACTORS == PLACED {
        within *= vec3f(own_share(extinction.r), own_share(extinction.g), own_share(extinction.b));
    }
    let albedo = reduced_albedo();
    var again = albedo;
    if FACTORS == PLACED {
        again = albedo / max(1.0 - albedo + albedo * mean_leaving(within), vec3f(LEAST));
    }
    media[3u * id.x] = vec4f(within, density);
    media[3u * id.x + 1u] = vec4f(again, 0.0);
    media[3u * id.x + 2u] = vec4f(even_rate(within, extinction), 0.0);
}
