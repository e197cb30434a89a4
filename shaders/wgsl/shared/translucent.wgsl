// Where surfaces are and how far light goes below them: planes [3, height, width], metres.

@group(0) @binding(3) var<storage, read> position_planes: array<f32>;
@group(0) @binding(4) var<storage, read> mean_free_path_planes: array<f32>;

// `index` is y * width + x, `pixels` height * width; camera space.
fn translucent_position(index: u32, pixels: u32) -> vec3f {
    return vec3f(position_planes[index], position_planes[index + pixels], position_planes[index + 2u * pixels]);
}
