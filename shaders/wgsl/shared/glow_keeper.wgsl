// Keepers of light, of which passes bind a list of KEEPER_WORDS numbers each: what it is part of, and, where
// any paint has textures, what it has of its paint's numbers (render/src/raster/glow.rs).

#constant KEEPER_WORDS = 1

// Four factors of two words.
fn keeper_factors(low: u32, high: u32) -> vec4f {
    return vec4f(unpack2x16float(low), unpack2x16float(high));
}
