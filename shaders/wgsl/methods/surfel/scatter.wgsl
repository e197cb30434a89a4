// Scattered light: what surfels give through the body, in the colour of the surface, and what of the pixel's own light
// they leave to it. So an evenly lit surface stays as it is whatever its surfels, and what goes from one side of a thin
// body to the other is missing there.

@group(0) @binding(0) var<uniform> image_size: LevelSum;
@group(0) @binding(1) var<storage, read> valid_plane: array<f32>;
// [6, height, width]: light, and the shares of the profile that it came by.
@group(0) @binding(2) var<storage, read> sums: array<f32>;
@group(0) @binding(3) var<storage, read> diffuse_light_planes: array<f32>;
@group(0) @binding(4) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

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
            let share = sums[here + 3u * pixels];
            // What layers one behind the other have beyond all of the profile does not add up: each takes its part of
            // what is left.
            let beyond = max(share - 1.0, 1e-3);
            let taken = (1.0 - exp(-beyond)) / beyond;
            let left = diffuse_light_planes[here] * (1.0 - taken * share);
            light = max(left + taken * diffuse_planes[here] * sums[here], 0.0);
        }
        image[here] = light;
    }
}
