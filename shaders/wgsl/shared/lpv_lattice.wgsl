// The 26 neighbours of a cell: render/src/lpv/lattice.rs.

// Of neighbours across a face, an edge and a corner: shares of all directions, and distances in cells.
const SHARES = vec3f(1.0 / 21.0, 4.0 / 105.0, 9.0 / 280.0);
const COUNTS = vec3f(6.0, 12.0, 8.0);
const DISTANCES = vec3f(1.0, 1.41421356, 1.7320508);
const LINKS = 13u;

// That of a number below 27, of which the thirteenth is the cell itself; x changes fastest.
fn neighbour(number: u32) -> vec3i {
    return vec3i(vec3u(number % 3u, number / 3u % 3u, number / 9u)) - 1;
}

fn kind_of(offset: vec3i) -> u32 {
    return u32(dot(offset, offset)) - 1u;
}
