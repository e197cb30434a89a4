// A level of sums over squares, each of 4 x 4 squares of the level before.

#import shared/net_squares
#constant LEVEL = 1

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = squares_size(LEVEL);
    if (id.x >= size.x || id.y >= size.y) {
        return;
    }
    let first = 4u * id.xy;
    let end = min(first + 4u, squares_size(LEVEL - 1u));
    var sums = vec2f(0.0);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            sums += squares[square_index(LEVEL - 1u, vec2u(x, y))];
        }
    }
    squares[square_index(LEVEL, id.xy)] = sums;
}
