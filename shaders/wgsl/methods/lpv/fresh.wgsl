// Light that surfaces send, which each iteration adds anew. They lie half a way from the middles of cells: what passes so far
// sets out from there, and is shown on the way. Nothing else is shown yet.

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [kinds, 3, cells]: lobes
@group(0) @binding(2) var<storage, read_write> state: array<vec4f>;
// [1 + SCATTERED + FIRST, 3, cells]
@group(0) @binding(3) var<storage, read_write> shown: array<vec4f>;
// [kinds, 3, cells]: flux and energy; then, if there is scattered light, [cells], as begin.wgsl writes it
@group(0) @binding(4) var<storage, read_write> source: array<vec4f>;
@group(0) @binding(5) var<uniform> medium: MediumRecord;
// [cells, 3]: as media.wgsl writes it; all 0 where there is no medium
@group(0) @binding(6) var<storage, read> media: array<vec4f>;

@compute @workgroup_size(64)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    let own = media[3u * id.x];
    let extinction = reduced_extinction() * own.w * grid.low.w;
    let face = grid.low.w * grid.low.w;
    for (var c = 0u; c < 3u; c++) {
        let first = 12u * id.x + 4u * c;
        let flux = face * vec3f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u));
        let sent = vec4f(flux, face * fixed_sum(first + 3u));
        let energies = by_kind(lobe(sent.xyz, sent.w)) / max(sent.w, 1e-37);
        var passes = 0.0;
        var way = 0.0;
        for (var kind = 0u; kind < 3u; kind++) {
            let enters = entering(own.rgb, extinction, kind);
            passes += energies[kind] * enters[c];
            way += energies[kind] * half_track(enters, extinction, kind)[c];
        }
        source[lobe_index(0u, c, id.x)] = sent * passes;
        state[lobe_index(0u, c, id.x)] = lobe(sent.xyz * passes, sent.w * passes);
        for (var light = 1u; light < UNSCATTERED; light++) {
            source[lobe_index(light, c, id.x)] = vec4f(0.0);
            state[lobe_index(light, c, id.x)] = vec4f(0.0);
        }
        if SCATTERED == 1u {
            // What collides, of which begin.wgsl makes scattered light.
            source[lobe_index(UNSCATTERED, c, id.x)] = vec4f(0.0, 0.0, 0.0, sent.w * (1.0 - passes));
        }
        for (var plane = 0u; plane <= SCATTERED + FIRST; plane++) {
            let is_shown = (plane == 0u && UNSCATTERED == 1u) || plane == 2u;
            shown[lobe_index(plane, c, id.x)] = select(vec4f(0.0), sent * way, is_shown);
        }
    }
}
