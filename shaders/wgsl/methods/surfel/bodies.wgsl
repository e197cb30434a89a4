// What scatters below each pixel: the length of the profile for each colour, 0 where light does not enter, and the object. The
// length is the mean free path over 1.9 - A + 3.5 (A - 0.8)^2, for light that enters evenly below a surface of colour A
// (Christensen and Burley 2015, equation 6).

@group(0) @binding(0) var<uniform> image_size: LevelSum;
@group(0) @binding(1) var<storage, read> valid_plane: array<f32>;
@group(0) @binding(2) var<storage, read> mean_free_path_planes: array<f32>;
@group(0) @binding(3) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(4) var<storage, read> object_plane: array<f32>;
// [4, height, width]
@group(0) @binding(5) var<storage, read_write> bodies: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn write_bodies(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image_size.width || id.y >= image_size.height {
        return;
    }
    let pixels = image_size.width * image_size.height;
    let at = id.y * image_size.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        let colour = diffuse_planes[at + c * pixels];
        let shape = 1.9 - colour + 3.5 * (colour - 0.8) * (colour - 0.8);
        let length = max(mean_free_path_planes[at + c * pixels], 0.0) / shape;
        bodies[at + c * pixels] = select(0.0, length, valid_plane[at] > 0.5);
    }
    bodies[at + 3u * pixels] = object_plane[at];
}
