// Patches: equal parts of a triangle, four times as many with each halving of its edges, so that none is much larger than
// what is seen as one distance.

struct Patch {
    corners: array<u32, 3>,
    // Halvings in the upper four bits; below them, 1 where the surface is open; in the lowest bits, two a halving, which quarter.
    part: u32,
    // Diffuse reflectance.
    colour: array<f32, 3>,
    // Share of it that is there: alpha.
    coverage: f32,
    // The mesh that it is part of, as object ids count them.
    object: u32,
}
