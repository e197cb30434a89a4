// What scatters below each pixel: the length of the profile for each colour, 0 where light does not enter,
// and the object; and a mask that tells bodies apart, 0 where no light enters.

#import shared/diffusion_length
#import uniforms/level_sum

@group(0) @binding(0) var<uniform> image_size: LevelSum;
@group(0) @binding(1) var<storage, read> valid_plane: array<f32>;
@group(0) @binding(2) var<storage, read> mean_free_path_planes: array<f32>;
@group(0) @binding(3) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(4) var<storage, read> object_plane: array<f32>;
// [4, height, width]
@group(0) @binding(5) var<storage, read_write> bodies: array<f32>;
// [1, height, width]
@group(0) @binding(6) var<storage, read_write> body_mask: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn write_bodies(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image_size.width || id.y >= image_size.height {
        return;
    }
    let pixels = image_size.width * image_size.height;
    let at = id.y * image_size.width + id.x;
    var enters = false;
    for (var c = 0u; c < 3u; c++) {
        let length = diffusion_length(mean_free_path_planes[at + c * pixels], diffuse_planes[at + c * pixels]);
        bodies[at + c * pixels] = select(0.0, length, valid_plane[at] > 0.5);
        enters = enters || bodies[at + c * pixels] > 0.0;
    }
    bodies[at + 3u * pixels] = object_plane[at];
    body_mask[at] = select(0.0, object_plane[at] + 1.0, enters);
}
