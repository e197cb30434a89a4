// Surfels of a frame, and the tree over them (thesis 4.2.1).

const PI = 3.14159265;
// Leaves of the tree hold so many surfels that lie one after the other; each node above has four children.
// The root is at HEIGHT.
const LEAF = 16u;

// What a frame's surfels are, and the workgroups of passes that run over them.
struct Totals {
    // Surfels that there are, and that there would be if there were room.
    kept: u32,
    wanted: u32,
    // Of 64 invocations each, one a surfel, one a leaf.
    surfel_groups: array<u32, 3>,
    leaf_groups: array<u32, 3>,
}

// Nodes of all heights in one array, the root first.
fn node_index(height: u32, index: u32) -> u32 {
    return ((1u << (2u * (HEIGHT - height))) - 1u) / 3u + index;
}

// The first surfel below a node.
fn first_surfel(height: u32, index: u32) -> u32 {
    return index * (LEAF << (2u * height));
}
