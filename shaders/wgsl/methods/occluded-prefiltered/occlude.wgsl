// The specular colour, dimmed by how open its surface is: a share that depends on the viewer's angle and the
// lobe's width (Lagarde and de Rousiers 2014, listing 26). The plain version is
// render/src/methods/occluded_prefiltered/mod.rs.

#import shared/phong_lobe
#import uniforms/prefiltered

@group(0) @binding(0) var<uniform> image: Prefiltered;
// Attributes, [channels, height, width].
@group(0) @binding(1) var<storage, read> world_normal: array<f32>;
@group(0) @binding(2) var<storage, read> to_camera: array<f32>;
@group(0) @binding(3) var<storage, read> glossiness: array<f32>;
@group(0) @binding(4) var<storage, read> specular: array<f32>;
// [height, width], the open share of the hemisphere
@group(0) @binding(5) var<storage, read> openness: array<f32>;
// [3, height, width]
@group(0) @binding(6) var<storage, read_write> open_specular: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn occlude(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image.width || id.y >= image.height {
        return;
    }
    let pixels = image.width * image.height;
    let at = id.y * image.width + id.x;
    var cosine = 0.0;
    for (var c = 0u; c < 3u; c++) {
        cosine += world_normal[at + c * pixels] * to_camera[at + c * pixels];
    }
    let open = openness[at];
    let sharpness = exp2(-16.0 * phong_alpha(1.0 - glossiness[at]) - 1.0);
    let share = clamp(pow(max(cosine, 0.0) + open, sharpness) - 1.0 + open, 0.0, 1.0);
    for (var c = 0u; c < 3u; c++) {
        open_specular[at + c * pixels] = share * specular[at + c * pixels];
    }
}
