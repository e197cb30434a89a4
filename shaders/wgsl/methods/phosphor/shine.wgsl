// What a medium's cells give back before the surface of each pixel, by a march, and what passes of the surface's own light. A
// cloud that nothing is seen through looks like a surface of its paint.

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(1) var<uniform> grid: GlowCells;
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

// What the cells around a point send, trilinear between their middles.
fn sent_at(point: vec3f) -> vec3f {
    let at = (point - grid.low.xyz) / (grid.high.xyz - grid.low.xyz) * grid.cells.xyz - 0.5;
    let within = clamp(at, vec3f(0.0), grid.cells.xyz - 1.0);
    let low = vec3u(within);
    let part = within - vec3f(low);
    let size = vec3u(grid.cells.xyz);
    var sent = vec3f(0.0);
    for (var i = 0u; i < 8u; i++) {
        let corner = vec3u(i & 1u, (i >> 1u) & 1u, i >> 2u);
        let weights = select(1.0 - part, part, corner == vec3u(1u));
        let cell = min(low + corner, size - 1u);
        let first = ((cell.z * size.y + cell.y) * size.x + cell.x) * STATES;
        for (var s = 0u; s < STATES; s++) {
            let weight = weights.x * weights.y * weights.z * states[first + s];
            sent += weight * paints[PAINT * STATES + s].emission.rgb;
        }
    }
    return sent;
}

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
