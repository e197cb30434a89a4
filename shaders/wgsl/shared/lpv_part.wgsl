// What of a cell lies in the medium's box, and eight points of it: render/src/lpv/injection.rs. Passes bind
// `grid` and `medium`.

#import shared/medium_span
#constant MEDIUM = 2

// The first of Gauss' two points along an edge, and from there to the second, as shares of it.
const GAUSS = vec2f(0.21132487, 0.57735026);

// The lowest corner and the edges, world space, metres; no edge is below 0.
struct CellPart {
    low: vec3f,
    size: vec3f,
}

fn part_in_medium(at: vec3i) -> CellPart {
    let low = grid.low.xyz + grid.low.w * vec3f(at);
    if MEDIUM == EVERYWHERE {
        return CellPart(low, vec3f(grid.low.w));
    }
    let begins = max(low, medium.low.xyz);
    let ends = min(low + grid.low.w, medium.high.xyz);
    return CellPart(begins, max(ends - begins, vec3f(0.0)));
}

// As a share of the cell.
fn share_of(part: CellPart) -> f32 {
    let edges = part.size / grid.low.w;
    return edges.x * edges.y * edges.z;
}

// One of its eight points.
fn part_point(part: CellPart, i: i32) -> vec3f {
    let corner = vec3f(vec3i(i & 1, (i >> 1u) & 1, i >> 2u));
    return part.low + part.size * (GAUSS.x + GAUSS.y * corner);
}
