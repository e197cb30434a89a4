// What surfaces around a cell reflect. Passes bind `links`, as links.wgsl writes it.
fn reflectance(cell: u32) -> vec3f {
    return vec3f((vec3u(links[cell].w) >> vec3u(8u, 16u, 24u)) & vec3u(255u)) / 255.0;
}
