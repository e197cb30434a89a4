// Sums over squares of 4 pixels, of a g-buffer's positions.

#import shared/net_squares
#import shared/surface_valid

@group(0) @binding(4) var<storage, read> position_planes: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let size = squares_size(0u);
    if (id.x >= size.x || id.y >= size.y) {
        return;
    }
    let first = 4u * id.xy;
    let end = min(first + 4u, vec2u(frame.width, frame.height));
    var sums = vec2f(0.0);
    for (var y = first.y; y < end.y; y++) {
        for (var x = first.x; x < end.x; x++) {
            let pixel = y * frame.width + x;
            if (surface_valid(pixel)) {
                let depth = -position_planes[pixel + 2u * frame.width * frame.height];
                sums += vec2f(depth, select(0.0, 1.0, depth > 0.0));
            }
        }
    }
    squares[square_index(0u, id.xy)] = sums;
}
