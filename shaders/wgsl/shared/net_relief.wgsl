// Depth against its means over squares.

#import shared/net_squares

// The sums of a level at a pixel, between the middles of four squares. Beyond the outermost these are the
// same.
fn squares_at(level: u32, at: vec2u) -> vec2f {
    let place = (vec2f(at) + 0.5) / f32(square_side(level)) - 0.5;
    let before = vec2i(floor(place));
    let last = vec2i(squares_size(level)) - 1;
    let near = vec2u(clamp(before, vec2i(0), last));
    let far = vec2u(clamp(before + 1, vec2i(0), last));
    let share = place - vec2f(before);
    let left = mix(
        squares[square_index(level, near)],
        squares[square_index(level, vec2u(near.x, far.y))],
        share.y,
    );
    let right = mix(
        squares[square_index(level, vec2u(far.x, near.y))],
        squares[square_index(level, far)],
        share.y,
    );
    return mix(left, right, share.x);
}

// A depth against its mean, over the radius, compressed to between -1 and 1; 0 where nothing is seen. Where
// something is, the pixel's own square has a weight.
fn relief(level: u32, at: vec2u, depth: f32) -> f32 {
    if (!(depth > 0.0)) {
        return 0.0;
    }
    let sums = squares_at(level, at);
    let value = (depth - sums.x / sums.y) / frame.radius;
    return value / (1.0 + abs(value));
}
