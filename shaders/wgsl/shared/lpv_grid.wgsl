// Cells of a light propagation volume: render/src/lpv/grid.rs. Passes bind `grid`.

fn cell_count() -> u32 {
    return u32(grid.size.w);
}

// A point of world space in cells from the lowest corner.
fn in_cells(point: vec3f) -> vec3f {
    return (point - grid.low.xyz) / grid.low.w;
}

fn is_cell(at: vec3i) -> bool {
    return all(at >= vec3i(0)) && all(at < vec3i(grid.size.xyz));
}

fn is_border(at: vec3i) -> bool {
    return any(at == vec3i(0)) || any(at == vec3i(grid.size.xyz) - 1);
}

fn cell_index(at: vec3i) -> u32 {
    let size = vec3i(grid.size.xyz);
    return u32((at.z * size.y + at.y) * size.x + at.x);
}

fn cell_at(index: u32) -> vec3i {
    let size = vec3u(grid.size.xyz);
    return vec3i(vec3u(index % size.x, index / size.x % size.y, index / (size.x * size.y)));
}

// Cubes of blockers lie between the middles of cells: one more along each axis.
fn cube_index(at: vec3i) -> u32 {
    let size = vec3i(grid.size.xyz) + 1;
    return u32((at.z * size.y + at.y) * size.x + at.x);
}
