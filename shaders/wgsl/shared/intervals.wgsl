// The transmittance interval map (Nalbach, Ritschel and Seidel 2014, 4.1): of each pixel's ray the distances
// between which the transmittance to the eye falls by equal parts of all that it falls by. How a ray's
// samples are kept is shared/intervals_encode_*. The plain version is
// render/src/methods/volume_shell/intervals.rs.

#import shared/bounded
#import shared/medium
#import shared/medium_span
#import shared/random
#import shared/surface_distance
#import shared/transmittance
#import shared/view
#import uniforms/frame_view
#import uniforms/medium_record
#constant SAMPLES = 16

/// What `methods/volume_shell/intervals` reads.
struct Intervals {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Points of a ray's way through the medium at which density is looked up.
    steps: u32,
    /// Chooses random offsets.
    seed: u32,
}

@group(0) @binding(0) var<uniform> marching: Intervals;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<uniform> medium: MediumRecord;
@group(0) @binding(3) var densities: texture_3d<f32>;
@group(0) @binding(4) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(5) var<storage, read> position_planes: array<f32>;
// [height, width, 4]: where the ray enters the medium, and where it leaves it or ends on a surface, metres;
// its density times length; the pixel's random offset.
@group(0) @binding(6) var<storage, read_write> rays: array<vec4f>;
// [height, width, SAMPLES / 2]: the samples.
@group(0) @binding(7) var<storage, read_write> samples: array<array<u32, SAMPLES / 2u>>;

// A ray's way through the medium in steps.
struct March {
    direction: vec3f,
    enters: f32,
    // Metres.
    step: f32,
    steps: u32,
    offset: f32,
}

// Density at a step.
fn density_at(step: u32, march: March) -> f32 {
    return density_inside(view.eye.xyz + march.direction * (march.enters + (f32(step) + march.offset) * march.step));
}

@compute @workgroup_size(TILE, TILE)
fn find_intervals(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= marching.width || id.y >= marching.height {
        return;
    }
    let at = id.y * marching.width + id.x;
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    let span = medium_span(view.eye.xyz, direction, surface_distance(at, marching.width * marching.height));
    let steps = bounded(marching.steps, id.xy);
    let step = max(span.y - span.x, 0.0) / f32(steps);
    // One random offset for all steps and all thresholds of a pixel: banding is worse than noise.
    let march = March(direction, span.x, step, steps, random(id.xy, marching.seed, 0u));
    var whole = 0.0;
    for (var i = 0u; i < steps; i++) {
        whole += density_at(i, march) * step;
    }
    rays[at] = vec4f(span, whole, march.offset);
    let least = mean_transmittance(whole);

    // The first is where density begins, the last where it ends.
    var next = 0u;
    var passed = 0.0;
    for (var i = 0u; i < steps; i++) {
        let here = density_at(i, march) * step;
        let before = mean_transmittance(passed);
        passed += here;
        let after = mean_transmittance(passed);
        while here > 0.0 && next < SAMPLES && after <= threshold(next, least, march.offset) {
            // Within a step transmittance falls evenly.
            let part = (before - threshold(next, least, march.offset)) / max(before - after, 1e-30);
            keep(next, i, clamp(part, 0.0, 1.0), march);
            next++;
        }
    }
    // What rounding leaves is at the end.
    while next < SAMPLES {
        keep(next, steps - 1u, 1.0, march);
        next++;
    }
    samples[at] = kept();
}
