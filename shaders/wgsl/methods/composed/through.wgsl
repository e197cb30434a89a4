// Dims light of the sky on surfaces by the medium on its way to them: by the mean over 14 directions, by
// their cosines. The plain version is render/src/methods/composed/through.rs.

#import shared/colours
#import shared/medium
#import shared/surface
#import shared/surface_valid
#import shared/view
#import uniforms/frame_view
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(4) var<uniform> medium: MediumRecord;
@group(0) @binding(5) var densities: texture_3d<f32>;
// [3, height, width]
@group(0) @binding(6) var<storage, read_write> part: array<f32>;

// Farther than any scene is large, metres.
const FAR = 1e5;
// Points of a way through a grid at which density is looked up.
const POINTS = 8u;

// Along axes and to corners of a cube; unit vectors.
fn way(number: u32) -> vec3f {
    if number < 8u {
        return (2.0 * vec3f(vec3u(number, number >> 1u, number >> 2u) & vec3u(1u)) - 1.0) * 0.57735027;
    }
    var along = vec3f(0.0);
    along[(number - 8u) / 2u] = select(1.0, -1.0, number % 2u == 1u);
    return along;
}

@compute @workgroup_size(TILE, TILE)
fn dim(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    if !surface_valid(at) {
        return;
    }
    let point = view.eye.xyz + from_view(surface_position(at, pixels), view);
    let normal = from_view(surface_normal(at, pixels), view);
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < 14u; i++) {
        let weight = max(dot(way(i), normal), 0.0);
        let passed = passed_density(point, way(i), FAR, POINTS);
        sum += weight * exp(-colours(medium.extinction.rgb) * passed);
        weights += weight;
    }
    for (var c = 0u; c < 3u; c++) {
        part[at + c * pixels] *= sum[c] / max(weights, 1e-6);
    }
}
