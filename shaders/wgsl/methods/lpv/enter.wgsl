// Light that a scene sends by itself, and that of the sky, which comes into cells along the border, before
// the first iteration, which adds it anew as do all others; and what is shown of the way to the middles of
// cells: render/src/lpv/sky.rs.

#import shared/lpv_fixed
#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lattice
#import shared/lpv_lobe
#import shared/lpv_medium
#import shared/medium
#import uniforms/light_grid
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [3, cells]: lobes
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;
// [3, cells]: flux and energy
@group(0) @binding(4) var<storage, read_write> source: array<vec4f>;
// By how much to multiply what an iteration shows.
@group(0) @binding(5) var<storage, read_write> weights: array<vec4f>;
@group(0) @binding(6) var<uniform> medium: MediumRecord;
// [cells, 3]: as media.wgsl writes it
@group(0) @binding(7) var<storage, read> media: array<vec4f>;
// [27]: what goes to each neighbour of a cell outside, watts over the area of a cell's face
@group(0) @binding(8) var<storage, read> sky: array<vec4f>;
@group(0) @binding(9) var densities: texture_3d<f32>;

// How far outside of the grid the medium is looked for, metres, and at how many points.
const OUTSIDE = 1e5;
const POINTS = 8u;

@compute @workgroup_size(64)
fn enter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    if id.x == 0u {
        weights[0] = vec4f(1.0);
    }
    let at = cell_at(id.x);
    let own = media[3u * id.x];
    let extinction = reduced_extinction() * own.w * grid.low.w;
    let face = grid.low.w * grid.low.w;
    var begun = mat3x4f();
    var halfway = mat3x4f();
    for (var c = 0u; c < 3u; c++) {
        let first = 12u * id.x + 4u * c;
        let flux = vec3f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u));
        begun[c] = vec4f(flux, fixed_sum(first + 3u));
    }
    for (var number = 0u; number < 27u; number++) {
        let offset = neighbour(number);
        if number == LINKS || is_cell(at - offset) {
            continue;
        }
        let kind = kind_of(offset);
        let gone = vec4f(normalize(vec3f(offset)) * kept_direction(kind), 1.0);
        let enters = entering(own.rgb, extinction, kind);
        let way = half_track(enters, extinction, kind);
        let enters_at = grid.low.xyz + grid.low.w * (vec3f(at) + 0.5 - 0.5 * vec3f(offset));
        let outside = passed_density(enters_at, -normalize(vec3f(offset)), OUTSIDE, POINTS);
        let sent = sky[number].rgb * exp(-reduced_extinction() * outside);
        for (var c = 0u; c < 3u; c++) {
            begun[c] += gone * (sent[c] * enters[c]);
            halfway[c] += gone * (sent[c] * way[c]);
        }
    }
    for (var c = 0u; c < 3u; c++) {
        let sent = face * begun[c];
        source[lobe_index(0u, c, id.x)] = sent;
        state[lobe_index(0u, c, id.x)] = lobe(sent.xyz, sent.w);
        shown[lobe_index(0u, c, id.x)] = face * halfway[c];
    }
}
