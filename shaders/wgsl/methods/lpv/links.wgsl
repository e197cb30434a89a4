// What passes between cells and the neighbours of which each link counts one: render/src/lpv/blockers.rs.

#import shared/lpv_fixed
#import shared/lpv_grid
#import shared/lpv_lattice
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<storage, read> sums: array<u32>;
// [cells, 4]: a byte a link, then one each for red, green and blue of what surfaces around the cell reflect
@group(0) @binding(2) var<storage, read_write> links: array<vec4u>;

// What a cube's surfaces hide on a way through it, in cells.
fn opacity(cube: vec3i, way: vec3f) -> f32 {
    let first = 9u * cube_index(cube);
    let along = vec3f(fixed_sum(first), fixed_sum(first + 1u), fixed_sum(first + 2u));
    let across = vec3f(fixed_sum(first + 3u), fixed_sum(first + 4u), fixed_sum(first + 5u));
    let squared = dot(along, way * way)
        + 2.0 * dot(across, vec3f(way.x * way.y, way.x * way.z, way.y * way.z));
    // Of a plane it is how often it is crossed, A |n . way| / s^2.
    return min(sqrt(max((along.x + along.y + along.z) * squared, 0.0)), 1.0);
}

// What is hidden: the mean of the cubes around the way.
fn hidden(at: vec3i, offset: vec3i) -> f32 {
    var sum = 0.0;
    var count = 0.0;
    for (var i = 0; i < 8; i++) {
        let corner = vec3i(i & 1, (i >> 1u) & 1, i >> 2u);
        if all((offset == vec3i(0)) | (corner == (offset + 1) / 2)) {
            sum += opacity(at + corner, vec3f(offset));
            count += 1.0;
        }
    }
    return sum / count;
}

// Mean reflectance of the surfaces around a cell, by their areas.
fn colour_around(at: vec3i) -> vec3f {
    var sum = vec3f(0.0);
    var area = 0.0;
    for (var i = 0; i < 8; i++) {
        let first = 9u * cube_index(at + vec3i(i & 1, (i >> 1u) & 1, i >> 2u));
        sum += vec3f(fixed_sum(first + 6u), fixed_sum(first + 7u), fixed_sum(first + 8u));
        area += fixed_sum(first) + fixed_sum(first + 1u) + fixed_sum(first + 2u);
    }
    return clamp(sum / max(area, 1e-30), vec3f(0.0), vec3f(1.0));
}

@compute @workgroup_size(64)
fn link(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    let at = cell_at(id.x);
    var words = vec4u(0u);
    for (var i = 0u; i < LINKS; i++) {
        let passes = u32(floor(255.0 * (1.0 - hidden(at, neighbour(LINKS + 1u + i))) + 0.5));
        words[i / 4u] |= passes << (8u * (i % 4u));
    }
    let colour = vec3u(floor(255.0 * colour_around(at) + 0.5));
    words.w |= (colour.r << 8u) | (colour.g << 16u) | (colour.b << 24u);
    links[id.x] = words;
}
