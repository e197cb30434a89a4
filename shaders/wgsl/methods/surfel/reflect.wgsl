// What a glossy surface reflects to the eye: what its lobe would if it were white, in its colour. Surfaces of
// one plane may be blurred into each other as long as they are white.

#import shared/gloss
#import shared/lobe
#import shared/surface
#import uniforms/level_sum

@group(0) @binding(0) var<uniform> image_size: LevelSum;
// [3, height, width]
@group(0) @binding(4) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn reflect_in_colour(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image_size.width || id.y >= image_size.height {
        return;
    }
    let pixels = image_size.width * image_size.height;
    let at = id.y * image_size.width + id.x;
    var colour = vec3f(0.0);
    if surface_valid(at) {
        let lobe = lobe_at(at, surface_position(at, pixels), surface_normal(at, pixels));
        colour = select(vec3f(0.0), fresnel(lobe, lobe.normal), shines(lobe));
    }
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] *= colour[c];
    }
}
