// How unit vectors, radiance and ways are packed into words.

// Octahedral map of the sphere onto [-1, 1]^2 (Cigolle et al. 2014, "A Survey of Efficient Representations
// for Independent Unit Vectors").
fn to_octahedron(direction: vec3f) -> vec2f {
    let flat = direction.xy / (abs(direction.x) + abs(direction.y) + abs(direction.z));
    if direction.z >= 0.0 {
        return flat;
    }
    return (1.0 - abs(flat.yx)) * select(vec2f(-1.0), vec2f(1.0), flat >= vec2f(0.0));
}

fn from_octahedron(flat: vec2f) -> vec3f {
    var direction = vec3f(flat, 1.0 - abs(flat.x) - abs(flat.y));
    if direction.z < 0.0 {
        let folded = (1.0 - abs(direction.yx)) * select(vec2f(-1.0), vec2f(1.0), direction.xy >= vec2f(0.0));
        direction = vec3f(folded, direction.z);
    }
    return normalize(direction);
}

// Red, green and blue with nine bits each and one exponent of five: 2^-24 to 65,408.
fn pack_radiance(radiance: vec3f) -> u32 {
    let bounded = clamp(radiance, vec3f(0.0), vec3f(65408.0));
    let largest = max(max(bounded.x, bounded.y), max(bounded.z, 0x1p-16));
    var exponent = clamp(floor(log2(largest)), -16.0, 15.0) + 1.0;
    // Rounding up may need one more.
    if floor(largest / exp2(exponent - 9.0) + 0.5) > 511.0 {
        exponent += 1.0;
    }
    let bits = vec3u(floor(bounded / exp2(exponent - 9.0) + 0.5));
    return bits.x | (bits.y << 9u) | (bits.z << 18u) | (u32(exponent + 15.0) << 27u);
}

fn unpack_radiance(word: u32) -> vec3f {
    let scale = exp2(f32(word >> 27u) - 24.0);
    return vec3f(vec3u(word, word >> 9u, word >> 18u) & vec3u(511u)) * scale;
}

// Three signed components with eight bits and a sign each and one exponent of five: of ways up to 65,536 m,
// to 1/256 of the longest component.
fn pack_way(way: vec3f) -> u32 {
    let largest = max(max(abs(way.x), abs(way.y)), max(abs(way.z), 0x1p-16));
    let exponent = clamp(floor(log2(largest)), -16.0, 15.0) + 1.0;
    let parts = clamp(floor(way / exp2(exponent - 8.0) + 0.5), vec3f(-255.0), vec3f(255.0));
    let bits = vec3u(vec3i(parts)) & vec3u(511u);
    return bits.x | (bits.y << 9u) | (bits.z << 18u) | (u32(exponent + 15.0) << 27u);
}

fn unpack_way(word: u32) -> vec3f {
    let parts = vec3i(extractBits(i32(word), 0u, 9u), extractBits(i32(word), 9u, 9u), extractBits(i32(word), 18u, 9u));
    return vec3f(parts) * exp2(f32(word >> 27u) - 23.0);
}
