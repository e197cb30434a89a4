// What a cell does to light that sets out from it: render/src/lpv/flight.rs. FACTORS says how collisions are counted.

const PLACED = 0u;
const EXPONENTIAL = 1u;
const LINEAR = 2u;

// Of light that sets out to a neighbour of a kind what leaves a cell with so much extinction on its part of the way.
fn leaving(within: vec3f, kind: u32) -> vec3f {
    if FACTORS == LINEAR {
        return 1.0 - within * dot(COUNTS * SHARES, DISTANCES);
    }
    return exp(-within * DISTANCES[kind]);
}

// The mean over all directions.
fn mean_leaving(within: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var kind = 0u; kind < 3u; kind++) {
        sum += COUNTS[kind] * SHARES[kind] * leaving(within, kind);
    }
    return sum;
}

// Of light that was scattered in the cell.
fn leaving_again(within: vec3f, kind: u32) -> vec3f {
    if FACTORS == PLACED {
        return leaving(within, kind);
    }
    return vec3f(1.0);
}

// What a cell sends out again of light of a lobe, over what it does of all that collides.
fn colliding(lobe: vec4f, within: vec3f, colour: u32) -> f32 {
    let left = vec3f(
        leaving(within, 0u)[colour],
        leaving(within, 1u)[colour],
        leaving(within, 2u)[colour],
    );
    return dot(by_kind(lobe), 1.0 - left);
}
