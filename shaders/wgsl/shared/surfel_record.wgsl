// Surfels: disks that stand for a scene's surface (thesis 4.2.1), in camera space, metres; 16 bytes each,
// since there may be a million. The same in Rust is render/src/surfels/surfel.rs.

#import shared/packing

struct Surfel {
    // Where its middle is.
    place: vec3f,
    // From the lowest bit on: its unit normal, octahedral, ten bits and ten; 1 where the surface is open, so
    // that its back is seen too; the bits of its radius.
    disk: u32,
}

// Radii have five bits of exponent and six of mantissa, those of an f32 from 2^-20 to 2^12 m; less is 0.
const LEAST_RADIUS = 107u << 23u;
const MOST_RADIUS_BITS = 2047u;
const LARGEST_COORDINATE = 511.0;

fn radius_of_bits(bits: u32) -> f32 {
    return select(bitcast<f32>(LEAST_RADIUS + (bits << 17u)), 0.0, bits == 0u);
}

// The bits of one of the two nearest radii, so that over all thresholds from 0 to 1 the mean area is right.
fn bits_of_radius(radius: f32, threshold: f32) -> u32 {
    let below = min((max(bitcast<u32>(radius), LEAST_RADIUS) - LEAST_RADIUS) >> 17u, MOST_RADIUS_BITS - 1u);
    let low = radius_of_bits(below);
    let high = radius_of_bits(below + 1u);
    return below + select(0u, 1u, radius * radius - low * low > threshold * (high * high - low * low));
}

fn new_surfel(place: vec3f, normal: vec3f, open: bool, radius_bits: u32) -> Surfel {
    let flat = vec2u(vec2i(floor(to_octahedron(normal) * LARGEST_COORDINATE + 0.5))) & vec2u(1023u);
    return Surfel(place, flat.x | (flat.y << 10u) | select(0u, 1u << 20u, open) | (radius_bits << 21u));
}

fn surfel_radius(surfel: Surfel) -> f32 {
    return radius_of_bits(surfel.disk >> 21u);
}

fn surfel_normal(surfel: Surfel) -> vec3f {
    let word = i32(surfel.disk);
    return from_octahedron(vec2f(vec2i(extractBits(word, 0u, 10u), extractBits(word, 10u, 10u))) / LARGEST_COORDINATE);
}

fn surfel_is_open(surfel: Surfel) -> bool {
    return extractBits(surfel.disk, 20u, 1u) == 1u;
}
