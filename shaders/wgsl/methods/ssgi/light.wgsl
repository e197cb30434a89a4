// Light of one diffuse bounce by visibility bitmasks before its blur, one invocation a pixel.
// The plain version is render/src/methods/ssgi/reference.rs.

#import shared/slices
#import shared/surface
#import shared/surface_valid

// Direct light reflected diffusely, radiance, [3, height, width].
@group(0) @binding(4) var<storage, read> diffuse_light: array<f32>;
// Irradiance over pi, [3, height, width].
@group(0) @binding(5) var<storage, read_write> indirect: array<f32>;

// The other side of a surface may be lit or not, but is not seen.
fn sent(index: u32, toward: vec3f) -> vec3f {
    let pixels = slices.width * slices.height;
    if dot(surface_normal(index, pixels), toward) >= 0.0 {
        return vec3f(0.0);
    }
    return vec3f(diffuse_light[index], diffuse_light[index + pixels], diffuse_light[index + 2u * pixels]);
}

@compute @workgroup_size(TILE, TILE)
fn gather_light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= slices.width || id.y >= slices.height {
        return;
    }
    let pixels = slices.width * slices.height;
    let index = id.y * slices.width + id.x;
    var light = vec3f(0.0);
    if surface_valid(index) {
        light = gather(id.xy).light;
    }
    indirect[index] = light.x;
    indirect[index + pixels] = light.y;
    indirect[index + 2u * pixels] = light.z;
}
