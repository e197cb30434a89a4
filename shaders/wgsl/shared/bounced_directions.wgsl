// What directions pixels look into are made of, other ones for neighbours.

#import shared/interleaved
#import shared/random

// The pixels of a square of 4 x 4 share one spiral of directions.
const SQUARE = 2u;
const IN_SQUARE = 16u;
// Angle between a direction of the spiral and the next, turns: the golden section of the circle.
const GOLDEN_TURN = 0.381966;

// A place on a disk, which they all fill evenly: its radius squared, and its angle, turns. `spread` is how
// many a pixel has, and a seed.
fn place_on_disk(pixel: vec2u, number: u32, spread: vec2u) -> vec2f {
    let square = pixel >> vec2u(SQUARE);
    let which = f32(IN_SQUARE * number + number_in_square(pixel, SQUARE, hash(spread.y)));
    let squared = (which + random(square, spread.y, 0u)) / f32(IN_SQUARE * spread.x);
    return vec2f(squared, fract(GOLDEN_TURN * which + random(square, spread.y, 1u)) - 0.5);
}
