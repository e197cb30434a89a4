// What the intervals of a pixel's ray scatter: filled in by `read_intervals`, of which there is one an
// encoding.

#import shared/colours
#constant SAMPLES = 16

const INTERVALS = SAMPLES - 1u;

// Where, metres from the eye, in order.
var<private> points: array<f32, INTERVALS>;
// What of light that is scattered there, over the phase function and 1/sr, arrives at the eye.
var<private> weights: array<vec3f, INTERVALS>;

fn share_of_colours(passed: f32) -> vec3f {
    return exp(-colours(medium.extinction.rgb) * passed);
}
