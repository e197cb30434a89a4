// Patches: equal parts of a triangle, four times as many with each halving of its edges, so that none is much
// larger than what is seen as one distance.

struct Patch {
    corners: array<u32, 3>,
    // Halvings in the upper four bits; below them, 1 where the surface is open; nine bits of coverage; in the
    // lower eighteen, two bits a halving, which quarter.
    part: u32,
    // Eleven, eleven and ten bits of the root of red, green and blue.
    colour: u32,
    // The mesh that it is part of, as object ids count them.
    object: u32,
}

// Share of a part that is there: alpha.
fn part_coverage(part: u32) -> f32 {
    return f32(extractBits(part, 18u, 9u)) / 511.0;
}

// Whether its back is seen too, since its surface is no closed one.
fn part_is_open(part: u32) -> bool {
    return extractBits(part, 27u, 1u) == 1u;
}

// Diffuse reflectance.
fn patch_colour(one: Patch) -> vec3f {
    let colour = one.colour;
    let parts = vec3u(extractBits(colour, 0u, 11u), extractBits(colour, 11u, 11u), extractBits(colour, 22u, 10u));
    let root = vec3f(parts) / vec3f(2047.0, 2047.0, 1023.0);
    return root * root;
}

// The weights of a patch's corners.
fn patch_weights(part: u32) -> mat3x3f {
    var at = mat3x3f(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    let halvings = part >> 28u;
    for (var i = 0u; i < halvings; i++) {
        let quarter = (part >> (2u * (halvings - 1u - i))) & 3u;
        let middles = mat3x3f(0.5 * (at[1] + at[2]), 0.5 * (at[2] + at[0]), 0.5 * (at[0] + at[1]));
        if quarter == 3u {
            at = middles;
        } else {
            at = mat3x3f(
                select(middles[(3u - quarter) % 3u], at[0], quarter == 0u),
                select(middles[(5u - quarter) % 3u], at[1], quarter == 1u),
                select(middles[(4u - quarter) % 3u], at[2], quarter == 2u),
            );
        }
    }
    return at;
}
