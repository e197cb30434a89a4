// What a cell does to light that sets out from it: render/src/lpv/flight.rs. FACTORS says how collisions are
// counted.

#import shared/lpv_lattice
#import shared/lpv_lobe
#constant FACTORS = 0

const PLACED = 0u;
const LINEAR = 1u;

// Of light that sets out to a neighbour of a kind what leaves a cell with so much extinction on its part of
// the way.
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

// Less extinction than this per cell counts as none where lengths are asked for.
const CLEAR = 1e-3;

// Length of a way on which so much passes; `whole` where nothing is lost.
fn track(passes: vec3f, extinction: vec3f, whole: f32) -> vec3f {
    return select(vec3f(whole), (1.0 - passes) / max(extinction, vec3f(CLEAR)), extinction > vec3f(CLEAR));
}

// That of half a way to a neighbour; where all collisions are in the cell that light leaves, so is all of the
// way.
fn half_track(passes: vec3f, extinction: vec3f, kind: u32) -> vec3f {
    if FACTORS != PLACED {
        return vec3f(0.0);
    }
    return track(passes, extinction, 0.5 * DISTANCES[kind]);
}

// Of light that comes in from a neighbour of a kind what passes to the middle.
fn entering(within: vec3f, extinction: vec3f, kind: u32) -> vec3f {
    return select(vec3f(1.0), exp(-(extinction - within) * DISTANCES[kind]), FACTORS == PLACED);
}

// What half a space of a medium reflects of diffuse light (Hapke 1981).
fn half_space(albedo: vec3f) -> vec3f {
    let gamma = sqrt(max(1.0 - albedo, vec3f(0.0)));
    return (1.0 - gamma) / (1.0 + gamma) * (1.0 - gamma / (3.0 + 3.0 * gamma));
}

// What goes in of light from a cell to another, by what both would send of even light.
fn let_in(there: vec3f, here: vec3f) -> vec3f {
    return select(vec3f(1.0), here / max(there, vec3f(1e-37)), there > here);
}
