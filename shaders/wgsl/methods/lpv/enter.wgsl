// Light that a scene sends by itself, and that of the sky, which comes into cells from outside, before the
// first iteration; and what is shown of the way to the middles of cells: render/src/lpv/sky.rs.

#import shared/lpv_steady
#import shared/medium

// [27]: what goes to each neighbour of a cell outside, watts over the area of a cell's face
@group(0) @binding(8) var<storage, read> sky: array<vec4f>;
@group(0) @binding(9) var densities: texture_3d<f32>;

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
        begun[c] = sent_into(id.x, c);
    }
    for (var number = 0u; number < 27u; number++) {
        let offset = neighbour(number);
        // What comes into the border comes of the coarser grid.
        if number == LINKS || is_border(at) || is_cell(at - offset) {
            continue;
        }
        let kind = kind_of(offset);
        let gone = vec4f(normalize(vec3f(offset)) * kept_direction(kind), 1.0);
        let enters = entering(own.rgb, extinction, kind);
        let way = half_track(enters, extinction, kind);
        let enters_at = grid.low.xyz + grid.low.w * (vec3f(at) + 0.5 - 0.5 * vec3f(offset));
        let outside = density_to_sky(enters_at, -normalize(vec3f(offset)));
        let sent = face * sky[number].rgb * exp(-reduced_extinction() * outside);
        for (var c = 0u; c < 3u; c++) {
            begun[c] += gone * (sent[c] * enters[c]);
            halfway[c] += gone * (sent[c] * way[c]);
        }
    }
    for (var c = 0u; c < 3u; c++) {
        set_out(0u, c, id.x, begun[c]);
        shown[lobe_index(0u, c, id.x)] = halfway[c];
    }
}
