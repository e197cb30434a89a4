// A tree over surfels in the order in which they lie: of each node a box around their middles.

struct Node {
    // Least coordinates; the largest `effect_distance` of a surfel below.
    low: vec4f,
    // Largest coordinates.
    high: vec4f,
}
