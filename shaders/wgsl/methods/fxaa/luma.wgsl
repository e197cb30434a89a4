// Luma of every pixel for fast approximate anti-aliasing (Lottes 2011): the square root of luminance, which
// grows about as seen brightness does. The plain version is render/src/methods/fxaa/reference.rs.

#import shared/picture
#import uniforms/fxaa

@group(0) @binding(0) var<uniform> fxaa: Fxaa;
@group(0) @binding(3) var<storage, read_write> luma: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn luma_of_light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= fxaa.width || id.y >= fxaa.height {
        return;
    }
    let index = id.y * fxaa.width + id.x;
    let luminance = dot(picture_light(index, fxaa.width * fxaa.height), vec3f(0.2126, 0.7152, 0.0722));
    luma[index] = sqrt(max(luminance, 0.0));
}
