// Sums over squares of 4, 16 and 64 pixels: of the depths that are seen, and of how many these are. The three
// levels lie one after the other, each row by row; squares at the right and at the bottom may be cut.

#import shared/net_frame

@group(0) @binding(2) var<storage, read_write> squares: array<vec2f>;

// Pixels of a square along an axis.
fn square_side(level: u32) -> u32 {
    return 4u << (2u * level);
}

// Columns and rows of a level.
fn squares_size(level: u32) -> vec2u {
    let side = square_side(level);
    return (vec2u(frame.width, frame.height) + side - 1u) / side;
}

fn square_index(level: u32, at: vec2u) -> u32 {
    var first = 0u;
    for (var finer = 0u; finer < level; finer++) {
        let size = squares_size(finer);
        first += size.x * size.y;
    }
    return first + at.y * squares_size(level).x + at.x;
}
