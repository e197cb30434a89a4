// The sharp picture: direct light, planes [3, height, width], black where no surface is seen.

@group(0) @binding(1) var<storage, read> light_planes: array<f32>;
@group(0) @binding(2) var<storage, read> valid_plane: array<f32>;

// `index` is y * width + x, `pixels` height * width.
fn picture_valid(index: u32) -> bool {
    return valid_plane[index] > 0.5;
}

fn picture_light(index: u32, pixels: u32) -> vec3f {
    if !picture_valid(index) {
        return vec3f(0.0);
    }
    return vec3f(light_planes[index], light_planes[index + pixels], light_planes[index + 2u * pixels]);
}
