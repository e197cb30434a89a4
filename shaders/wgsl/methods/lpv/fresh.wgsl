// Light that surfaces send, before the first iteration; nothing is shown yet. Where it is STEADY each
// iteration adds it anew, and of what lies half a way from the middle of its cell only what passes so far
// sets out from there; it is shown on the way.

#import shared/lpv_fixed
#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lobe
#import shared/lpv_medium
#import shared/lpv_second
#import uniforms/light_grid
#import uniforms/medium_record
#constant FIRST = 1
#constant SCATTERED = 1
#constant STEADY = 1
#constant UNSCATTERED = 2

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [kinds, 3, cells]: lobes; then what begin.wgsl writes; then [kinds, 5, cells]: second moments, of three
// bands alone
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [1 + SCATTERED + FIRST, 3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;
// [3, cells]: flux and energy of steady light
@group(0) @binding(4) var<storage, read_write> source: array<vec4f>;
@group(0) @binding(5) var<uniform> medium: MediumRecord;
// [cells, 3]: as media.wgsl writes it; all 0 where there is no medium
@group(0) @binding(6) var<storage, read> media: array<vec4f>;

// Of light that is sent, what passes to the middle of its cell and the length of its way there.
fn first_half(sent: vec4f, cell: u32, colour: u32) -> vec2f {
    let own = media[3u * cell];
    let extinction = reduced_extinction() * own.w * grid.low.w;
    let energies = by_kind(lobe(sent.xyz, sent.w)) / max(sent.w, 1e-37);
    var sums = vec2f(0.0);
    for (var kind = 0u; kind < 3u; kind++) {
        let enters = entering(own.rgb, extinction, kind);
        sums += energies[kind] * vec2f(enters[colour], half_track(enters, extinction, kind)[colour]);
    }
    return sums;
}

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    var all: mat3x4f;
    for (var c = 0u; c < 3u; c++) {
        let first = 12u * id.x + 4u * c;
        let face = grid.low.w * grid.low.w;
        let flux = face * vec3f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u));
        var sent = vec4f(flux, face * fixed_sum(first + 3u));
        var on_the_way = vec4f(0.0);
        if STEADY == 1u {
            let half = first_half(sent, id.x, c);
            on_the_way = sent * half.y;
            sent *= half.x;
            source[lobe_index(0u, c, id.x)] = sent;
        }
        all[c] = sent;
        state[lobe_index(0u, c, id.x)] = lobe(sent.xyz, sent.w);
        for (var light = 1u; light < UNSCATTERED; light++) {
            state[lobe_index(light, c, id.x)] = vec4f(0.0);
        }
        for (var plane = 0u; plane <= SCATTERED + FIRST; plane++) {
            shown[lobe_index(plane, c, id.x)] = on_the_way;
        }
    }
    keep_second(0u, id.x, second_begun(all));
    for (var light = 1u; light < UNSCATTERED; light++) {
        keep_second(light, id.x, Second());
    }
}
