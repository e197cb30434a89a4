// Scattered light: what surfels on the pixel's side give through the body, in the colour of the surface, and
// what of the pixel's own light they leave to it; of both what those on the far side of a thin body leave,
// and what they give. So an evenly lit surface stays as it is whatever its surfels.

#import uniforms/level_sum

@group(0) @binding(0) var<uniform> image_size: LevelSum;
@group(0) @binding(1) var<storage, read> valid_plane: array<f32>;
// [12, height, width]: light, and the shares of the profile that it came by, of the pixel's side, then of the
// other.
@group(0) @binding(2) var<storage, read> sums: array<f32>;
@group(0) @binding(3) var<storage, read> diffuse_light_planes: array<f32>;
@group(0) @binding(4) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

// Light of one colour from one side and its share of the profile, without what layers one behind the other
// have beyond all of the profile.
fn bounded_side(first: u32, pixels: u32) -> vec2f {
    let share = sums[first + 3u * pixels];
    return vec2f(sums[first], share) / max(share, 1.0);
}

@compute @workgroup_size(TILE, TILE)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image_size.width || id.y >= image_size.height {
        return;
    }
    let pixels = image_size.width * image_size.height;
    let at = id.y * image_size.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        let here = at + c * pixels;
        var light = image_size.background;
        if valid_plane[at] > 0.5 {
            let near = bounded_side(here, pixels);
            let far = bounded_side(here + 6u * pixels, pixels);
            let above = diffuse_light_planes[here] * (1.0 - near.y) + diffuse_planes[here] * near.x;
            light = above * (1.0 - far.y) + diffuse_planes[here] * far.x;
        }
        image[here] = light;
    }
}
