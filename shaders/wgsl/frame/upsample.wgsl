// An image of fewer pixels in full size: each pixel takes the mean of the four around it there, of those that
// show the same surface (Kopf et al. 2007, "Joint Bilateral Upsampling").

#import shared/surface
#import shared/surface_valid
#import uniforms/upsampling
#constant CHANNELS = 1

@group(0) @binding(0) var<uniform> settings: Upsampling;
// Of the smaller image, as `shared/surface` has those of the full one.
@group(0) @binding(4) var<storage, read> small_positions: array<f32>;
@group(0) @binding(5) var<storage, read> small_normals: array<f32>;
@group(0) @binding(6) var<storage, read> small_valid: array<f32>;
// [CHANNELS, small height, small width]
@group(0) @binding(7) var<storage, read> small_image: array<f32>;
// [CHANNELS, height, width]
@group(0) @binding(8) var<storage, read_write> image: array<f32>;

// Off a pixel's plane by this share of its distance, a neighbour counts half.
const TOLERANCE = 0.005;
// What each neighbour counts at least, so that some value is found where none is alike.
const LEAST = 1e-4;

fn small_position(at: u32, pixels: u32) -> vec3f {
    return vec3f(small_positions[at], small_positions[at + pixels], small_positions[at + 2u * pixels]);
}

fn small_normal(at: u32, pixels: u32) -> vec3f {
    return vec3f(small_normals[at], small_normals[at + pixels], small_normals[at + 2u * pixels]);
}

@compute @workgroup_size(TILE, TILE)
fn upsample(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.width || id.y >= settings.height {
        return;
    }
    let pixels = settings.width * settings.height;
    let at = id.y * settings.width + id.x;
    let small = vec2u(settings.small_width, settings.small_height);
    let small_pixels = small.x * small.y;
    var sum = array<f32, CHANNELS>();
    var weights = 0.0;
    if surface_valid(at) {
        let position = surface_position(at, pixels);
        let normal = surface_normal(at, pixels);
        let scale = vec2f(settings.columns, settings.rows);
        let there = (vec2f(id.xy) + settings.corner) * scale - settings.corner;
        let corner = floor(there);
        let part = there - corner;
        for (var i = 0u; i < 4u; i++) {
            let side = vec2u(i & 1u, i >> 1u);
            let tap = vec2u(clamp(vec2i(corner) + vec2i(side), vec2i(0), vec2i(small) - 1));
            let here = tap.y * small.x + tap.x;
            if small_valid[here] <= 0.5 {
                continue;
            }
            let near = select(1.0 - part, part, side == vec2u(1u));
            let off = dot(small_position(here, small_pixels) - position, normal) / (TOLERANCE * length(position));
            let facing = max(dot(small_normal(here, small_pixels), normal), 0.0);
            let alike = pow(facing, 8.0) / (1.0 + off * off);
            let weight = max(near.x * near.y * alike, LEAST);
            for (var c = 0u; c < CHANNELS; c++) {
                sum[c] += weight * small_image[here + c * small_pixels];
            }
            weights += weight;
        }
    }
    for (var c = 0u; c < CHANNELS; c++) {
        image[at + c * pixels] = select(settings.background, sum[c] / weights, weights > 0.0);
    }
}
