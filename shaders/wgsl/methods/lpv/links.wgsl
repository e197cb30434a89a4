// What passes between cells and the neighbours of which each link counts one: render/src/lpv/blockers.rs.

#import shared/lpv_blockers
#import shared/lpv_grid
#import shared/lpv_lattice
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cubes, 17]: as inject.wgsl writes it
@group(0) @binding(1) var<storage, read> blockers: array<u32>;
// [cells, 4]: a byte a link, then one each for red, green and blue of what surfaces around the cell reflect
@group(0) @binding(2) var<storage, read_write> links: array<vec4u>;

// Mean reflectance of the surfaces around a cell, by their areas.
fn colour_around(at: vec3i) -> vec3f {
    var sums = vec4f(0.0);
    for (var i = 0; i < 8; i++) {
        let cube = cube_index(at + vec3i(i & 1, (i >> 1u) & 1, i >> 2u));
        for (var c = 0u; c < 4u; c++) {
            sums[c] += f32(blockers[BLOCKER_WORDS * cube + LINKS + c]) / BLOCKER_ONE;
        }
    }
    return clamp(sums.rgb / max(sums.a, 1e-30), vec3f(0.0), vec3f(1.0));
}

@compute @workgroup_size(64)
fn link(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    let at = cell_at(id.x);
    var words = vec4u(0u);
    for (var i = 0u; i < LINKS; i++) {
        let covered = f32(blockers[BLOCKER_WORDS * cube_index(at) + i]) / BLOCKER_ONE;
        let passes = u32(floor(255.0 * (1.0 - min(covered, 1.0)) + 0.5));
        words[i / 4u] |= passes << (8u * (i % 4u));
    }
    let colour = vec3u(floor(255.0 * colour_around(at) + 0.5));
    words.w |= (colour.r << 8u) | (colour.g << 16u) | (colour.b << 24u);
    links[id.x] = words;
}
