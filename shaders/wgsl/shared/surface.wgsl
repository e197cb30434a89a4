// What the g-buffer knows of the surface seen at each pixel: planes [channels, height, width], camera space,
// metres.

@group(0) @binding(1) var<storage, read> position_planes: array<f32>;
@group(0) @binding(2) var<storage, read> normal_planes: array<f32>;

// `index` is y * width + x, `pixels` height * width.
fn surface_position(index: u32, pixels: u32) -> vec3f {
    return vec3f(position_planes[index], position_planes[index + pixels], position_planes[index + 2u * pixels]);
}

fn surface_normal(index: u32, pixels: u32) -> vec3f {
    return vec3f(normal_planes[index], normal_planes[index + pixels], normal_planes[index + 2u * pixels]);
}
