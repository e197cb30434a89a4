// What the base reflects of the light that arrives, and what the specular lobe does. The plain version is
// render/src/methods/occluded_prefiltered/mod.rs.

#import uniforms/prefiltered

@group(0) @binding(0) var<uniform> image: Prefiltered;
// [3, height, width] each
@group(0) @binding(1) var<storage, read> diffuse: array<f32>;
// irradiance over pi
@group(0) @binding(2) var<storage, read> light: array<f32>;
@group(0) @binding(3) var<storage, read> mirrored: array<f32>;
@group(0) @binding(4) var<storage, read_write> radiance: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn sum(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image.width || id.y >= image.height {
        return;
    }
    let pixels = image.width * image.height;
    let at = id.y * image.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        let here = at + c * pixels;
        radiance[here] = diffuse[here] * light[here] + mirrored[here];
    }
}
