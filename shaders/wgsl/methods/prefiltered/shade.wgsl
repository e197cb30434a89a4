// Light from a prefiltered environment, one invocation a pixel (Kautz et al. 2000; McAllister et al. 2002).
// The plain version is render/src/methods/prefiltered/reference.rs; both do the same, line by line.

#import shared/environment
#import shared/phong_lobe
#import uniforms/prefiltered
#constant ANGLES = 32
#constant EXPONENTS = 26
#constant LEVELS = 14

@group(0) @binding(0) var<uniform> image: Prefiltered;
// Attributes, [channels, height, width].
@group(0) @binding(1) var<storage, read> world_normal: array<f32>;
@group(0) @binding(2) var<storage, read> to_camera: array<f32>;
@group(0) @binding(3) var<storage, read> diffuse: array<f32>;
@group(0) @binding(4) var<storage, read> specular: array<f32>;
@group(0) @binding(5) var<storage, read> glossiness: array<f32>;
@group(0) @binding(6) var<storage, read> valid: array<f32>;
// First texel and height of LEVELS maps; lobes for EXPONENTS times ANGLES; the maps' texels.
@group(0) @binding(7) var<storage, read> environment: array<vec4f>;
// [3, height, width]
@group(0) @binding(8) var<storage, read_write> radiance: array<f32>;

// Energy, lean and level, bilinear in the table, by the cosine of the mirrored direction to the normal.
fn lobe_of(exponent: f32, cosine: f32) -> vec3f {
    let row = clamp(2.0 * log2(exponent + 1.0), 0.0, f32(EXPONENTS - 1u));
    let column = sqrt(clamp(cosine, 0.0, 1.0)) * f32(ANGLES - 1u);
    let top = min(u32(row), EXPONENTS - 2u);
    let left = min(u32(column), ANGLES - 2u);
    let first = LEVELS + top * ANGLES + left;
    let upper = mix(environment[first].xyz, environment[first + 1u].xyz, column - f32(left));
    let lower = mix(environment[first + ANGLES].xyz, environment[first + ANGLES + 1u].xyz, column - f32(left));
    return mix(upper, lower, row - f32(top));
}

fn filtered(level: u32, direction: vec3f) -> vec3f {
    let map = environment[level];
    return environment_radiance(u32(map.x), u32(map.y), direction);
}

@compute @workgroup_size(TILE, TILE)
fn shade(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= image.width || id.y >= image.height {
        return;
    }
    let x = id.y * image.width + id.x;
    let y = x + image.width * image.height;
    let z = y + image.width * image.height;
    var light = vec3f(0.0);
    if valid[x] > 0.5 {
        let normal = vec3f(world_normal[x], world_normal[y], world_normal[z]);
        let viewer = vec3f(to_camera[x], to_camera[y], to_camera[z]);
        let cosine = dot(normal, viewer);
        let mirrored = 2.0 * cosine * normal - viewer;
        let lobe = lobe_of(phong_exponent(phong_alpha(1.0 - glossiness[x])), cosine);
        let direction = normalize(mix(mirrored, normal, lobe.y));
        let level = min(u32(lobe.z), LEVELS - 2u);
        let reflected = mix(filtered(level, direction), filtered(level + 1u, direction), lobe.z - f32(level));
        light = vec3f(diffuse[x], diffuse[y], diffuse[z]) * filtered(0u, normal)
            + vec3f(specular[x], specular[y], specular[z]) * lobe.x * reflected;
    }
    radiance[x] = light.x;
    radiance[y] = light.y;
    radiance[z] = light.z;
}
