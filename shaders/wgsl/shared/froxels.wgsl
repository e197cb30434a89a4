// The froxels of a view: columns of slices, which are thinner near the eye. Slices divide each ray's own way
// through the medium. Passes bind `froxels`, `view` and `medium`.

#import shared/growing
#import shared/medium_span

// Steps of a sequence that fills a cube evenly (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom
// Sequences").
const STRIDE = vec3f(0.8191725, 0.6710436, 0.5497005);

// Where in their columns froxels are lit, and where in their steps, in this frame.
fn froxel_shift() -> vec3f {
    return fract(0.5 + f32(froxels.frame) * STRIDE);
}

// From which distance to which there are froxels on a ray: where the medium is, and as far as it is seen.
fn froxel_range(direction: vec3f) -> vec2f {
    let span = medium_span(view.eye.xyz, direction, 1e30);
    return vec2f(span.x, max(span.y, span.x));
}

// Where a slice begins.
fn slice_distance(slice: f32, range: vec2f) -> f32 {
    return mix(range.x, range.y, growing(slice / f32(froxels.slices)));
}

// Which fractional slice is at a distance.
fn slice_at(distance: f32, range: vec2f) -> f32 {
    let passed = clamp((distance - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0);
    return f32(froxels.slices) * share_of_parts(passed);
}
