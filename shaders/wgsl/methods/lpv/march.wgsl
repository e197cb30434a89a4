// What the medium in front of pixels scatters to the eye of the grid's light, by a march; of one pixel of
// SCALE x SCALE, since it hardly changes from pixel to pixel.

#import shared/bounded
#import shared/lpv_irradiance
#import shared/mean_decay
#import shared/medium
#import shared/medium_span
#import shared/random
#import shared/surface_distance
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid
#import uniforms/marching
#import uniforms/medium_record
#constant SCALE = 1

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> march: Marching;
@group(0) @binding(2) var<uniform> medium: MediumRecord;
@group(0) @binding(3) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(4) var<storage, read> position_planes: array<f32>;
@group(0) @binding(5) var<uniform> view: FrameView;
@group(0) @binding(6) var<storage, read> shown: array<vec4f>;
// [3, height / SCALE, width / SCALE], rounded up
@group(0) @binding(7) var<storage, read_write> scattered: array<f32>;
@group(0) @binding(8) var densities: texture_3d<f32>;

const PI = 3.14159265;

// Where a ray is in the grid's box.
fn grid_span(origin: vec3f, direction: vec3f, span: vec2f) -> vec2f {
    let along = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let high = grid.low.xyz + grid.low.w * grid.size.xyz;
    let a = (grid.low.xyz - origin) / along;
    let b = (high - origin) / along;
    let enters = min(a, b);
    let leaves = max(a, b);
    let begins = max(span.x, max(enters.x, max(enters.y, enters.z)));
    let ends = min(span.y, min(leaves.x, min(leaves.y, leaves.z)));
    return vec2f(begins, max(begins, ends));
}

// Radiance that a metre of density 1 sends along a direction, over its scattering coefficient.
fn scattered_along(point: vec3f, direction: vec3f) -> vec3f {
    let around = taps(point);
    var all = vec3f(0.0);
    var flux = mat3x3f();
    for (var i = 0; i < 8; i++) {
        let corner = vec3i(i & 1, (i >> 1u) & 1, i >> 2u);
        let light = fluence_of_cell(min(around.low + corner, vec3i(grid.size.xyz) - 1), 0u);
        let weight = tap_weight(around, corner);
        all += weight * light.all;
        flux += weight * light.flux;
    }
    let directed = 3.0 * medium.scattering.w * (direction * flux);
    return max(all + directed, vec3f(0.0)) / (4.0 * PI * grid.low.w * grid.low.w);
}

@compute @workgroup_size(TILE, TILE)
fn shade(@builtin(global_invocation_id) id: vec3u) {
    let small = (vec2u(march.width, march.height) + SCALE - 1u) / SCALE;
    if id.x >= small.x || id.y >= small.y {
        return;
    }
    let pixel = id.xy * SCALE;
    let reach = surface_distance(pixel.y * march.width + pixel.x, march.width * march.height);
    let direction = from_view(normalize(view_position(vec2f(pixel) + 0.5, 1.0, view)), view);
    let eye = view.eye.xyz;
    let in_medium = medium_span(eye, direction, reach);
    let span = grid_span(eye, direction, vec2f(in_medium.x, max(in_medium.x, in_medium.y)));
    let steps = bounded(march.steps, pixel);
    let step = (span.y - span.x) / f32(steps);
    let shift = random(pixel, march.seed, 0u);
    let extinction = medium.extinction.rgb;
    // What passes before the grid begins.
    var passed = exp(-extinction * passed_density(eye, direction, span.x, 8u));
    var sum = vec3f(0.0);
    for (var i = 0u; i < steps; i++) {
        let point = eye + direction * (span.x + (f32(i) + shift) * step);
        let here = density_inside(point) * step;
        sum += passed * mean_decay(extinction * here) * here * scattered_along(point, -direction);
        passed *= exp(-extinction * here);
    }
    for (var c = 0u; c < 3u; c++) {
        let at = id.x + small.x * (id.y + small.y * c);
        scattered[at] = sum[c] * medium.scattering[c];
    }
}
