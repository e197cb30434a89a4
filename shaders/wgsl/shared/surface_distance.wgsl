// Where a pixel's surface is, along the ray; far away where none is seen. Passes bind `valid_plane` and
// `position_planes`.
fn surface_distance(at: u32, pixels: u32) -> f32 {
    let position = vec3f(position_planes[at], position_planes[at + pixels], position_planes[at + 2u * pixels]);
    return select(1e30, length(position), valid_plane[at] > 0.5);
}
