// What a medium's cells give back before the surface of each pixel, by a march, and what passes of the
// surface's own light. A cloud that nothing is seen through looks like a surface of its paint.

#import shared/glow_cells
#import shared/mean_decay
#import shared/medium
#import shared/medium_span
#import shared/surface_distance
#import shared/view
#import uniforms/frame_view
#import uniforms/glow_cells
#import uniforms/medium_record
#import uniforms/paint_state
#constant PAINT_STATES = 1

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(1) var<uniform> lattice: GlowCells;
@group(0) @binding(2) var<uniform> view: FrameView;
@group(0) @binding(3) var<uniform> medium: MediumRecord;
@group(0) @binding(4) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(5) var<storage, read> position_planes: array<f32>;
@group(0) @binding(6) var<storage, read> states: array<f32>;
// [3, height, width]: light of surfaces, then of both
@group(0) @binding(7) var<storage, read_write> image: array<f32>;
@group(0) @binding(8) var densities: texture_3d<f32>;

// Pieces of a way through the medium.
const STEPS = 64u;

@compute @workgroup_size(TILE, TILE)
fn shine(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let pixel = id.y * view.width + id.x;
    let reach = surface_distance(pixel, pixels);
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    let span = medium_span(view.eye.xyz, direction, reach);
    let step = max(span.y - span.x, 0.0) / f32(STEPS);
    let extinction = medium.extinction.rgb;
    var passes = vec3f(1.0);
    var sum = vec3f(0.0);
    for (var i = 0u; i < STEPS; i++) {
        let point = view.eye.xyz + direction * (span.x + (f32(i) + 0.5) * step);
        // Behind more than that nothing is seen.
        let depth = min(extinction * (density_inside(point) * step), vec3f(80.0));
        // Without loss where little is hidden.
        let hidden = depth * mean_decay(depth);
        sum += passes * hidden * sent_at(point);
        passes *= 1.0 - hidden;
    }
    for (var c = 0u; c < 3u; c++) {
        let at = pixel + c * pixels;
        image[at] = passes[c] * image[at] + sum[c];
    }
}
