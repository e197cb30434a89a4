// The medium in front of each pixel, from an image of fewer pixels of which those count whose surfaces are as
// far away (Kopf et al. 2007), and the surface behind it, lit by the grid's light. ADDS says that
// other light is there already, of another kind.

#import shared/lpv_irradiance
#import shared/medium
#import shared/surface
#import shared/surface_valid
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid
#import uniforms/marching
#import uniforms/medium_record
#constant ADDS = 1
#constant LIT = 1
#constant SCALE = 1
#constant SCATTERED = 1
#constant SCATTERS = 1

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(4) var<uniform> view: FrameView;
@group(0) @binding(5) var<storage, read> shown: array<vec4f>;
// [3, height, width]
@group(0) @binding(6) var<storage, read_write> image: array<f32>;
@group(0) @binding(7) var<uniform> march: Marching;
@group(0) @binding(8) var<uniform> medium: MediumRecord;
@group(0) @binding(9) var densities: texture_3d<f32>;
// [3, height, width]
@group(0) @binding(10) var<storage, read> diffuse_planes: array<f32>;
// [3, height / SCALE, width / SCALE], rounded up
@group(0) @binding(11) var<storage, read> scattered: array<f32>;

const PI = 3.14159265;
// Farther or nearer by this share of its distance, a neighbour counts half.
const TOLERANCE = 0.02;
// What each neighbour counts at least.
const LEAST = 1e-4;
// Points of the way to a surface at which a grid's density is looked up.
const POINTS = 16u;

fn distance_of(pixel: vec2u) -> f32 {
    let at = pixel.y * march.width + pixel.x;
    return select(1e30, length(surface_position(at, march.width * march.height)), surface_valid(at));
}

fn scattered_before(pixel: vec2u, reach: f32) -> vec3f {
    let small = (vec2u(march.width, march.height) + SCALE - 1u) / SCALE;
    let low = pixel / SCALE;
    let part = vec2f(pixel - low * SCALE) / f32(SCALE);
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2u(i & 1u, i >> 1u);
        let tap = min(low + corner, small - 1u);
        let near = select(1.0 - part, part, corner == vec2u(1u));
        let off = (distance_of(tap * SCALE) - reach) / (TOLERANCE * reach);
        let weight = max(near.x * near.y / (1.0 + off * off), LEAST * near.x * near.y);
        let at = tap.x + small.x * tap.y;
        let count = small.x * small.y;
        sum += weight * vec3f(scattered[at], scattered[at + count], scattered[at + 2u * count]);
        weights += weight;
    }
    return sum / weights;
}

@compute @workgroup_size(TILE, TILE)
fn apply(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= march.width || id.y >= march.height {
        return;
    }
    let pixels = march.width * march.height;
    let at = id.y * march.width + id.x;
    let reach = distance_of(id.xy);
    var sum = vec3f(0.0);
    if SCATTERS == 1u {
        sum += scattered_before(id.xy, reach);
    }
    if LIT == 1u && surface_valid(at) {
        let offset = from_view(surface_position(at, pixels), view);
        let passed = exp(-medium.extinction.rgb * passed_density(view.eye.xyz, normalize(offset), reach, POINTS));
        let diffuse = vec3f(diffuse_planes[at], diffuse_planes[at + pixels], diffuse_planes[at + 2u * pixels]);
        let normal = from_view(surface_normal(at, pixels), view);
        let point = view.eye.xyz + offset;
        sum += passed * diffuse / PI * irradiance(point, normal, SCATTERED);
    }
    for (var c = 0u; c < 3u; c++) {
        if ADDS == 1u {
            sum[c] += image[at + c * pixels];
        }
        image[at + c * pixels] = sum[c];
    }
}
