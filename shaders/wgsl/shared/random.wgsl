// Random numbers of a pixel: the same as Rust's `deepshade_shaders::random`, bit for bit.

// PCG's output permutation as a hash (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering").
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// A number in [0, 1) for each pixel, seed and dimension.
fn random(pixel: vec2u, seed: u32, dimension: u32) -> f32 {
    let bits = hash(pixel.x + hash(pixel.y + hash(seed + hash(dimension))));
    return f32(bits >> 8u) * 0x1p-24;
}
