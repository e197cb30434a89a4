// Directions that pixels look into, spread by their cosine to the normal, other ones for neighbours.

// The pixels of a square of 4 x 4 share one spiral of directions.
const SQUARE = 2u;
const IN_SQUARE = 16u;
// Angle between a direction of the spiral and the next, turns: the golden section of the circle.
const GOLDEN_TURN = 0.381966;
const TAU = 6.2831853;

// A direction of a pixel, by how many it has and a seed (`spread`): a spiral over the disk, lifted onto the hemisphere, has the
// density cosine / pi (Malley's method).
fn direction_of(pixel: vec2u, number: u32, spread: vec2u, normal: vec3f) -> vec3f {
    let square = pixel >> vec2u(SQUARE);
    let which = f32(IN_SQUARE * number + number_in_square(pixel, SQUARE, hash(spread.y)));
    let squared = (which + random(square, spread.y, 0u)) / f32(IN_SQUARE * spread.x);
    let angle = TAU * (fract(GOLDEN_TURN * which + random(square, spread.y, 1u)) - 0.5);
    let disk = sqrt(squared) * vec2f(cos(angle), sin(angle));
    // Two tangents (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let tangent = vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    let bitangent = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
    return disk.x * tangent + disk.y * bitangent + sqrt(1.0 - squared) * normal;
}

// One over it, and a large number where it is nothing.
fn inverse_of(direction: vec3f) -> vec3f {
    return 1.0 / select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
}
