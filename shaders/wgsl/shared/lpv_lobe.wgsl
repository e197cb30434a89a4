// How light is spread over directions: render/src/lpv/lobe.rs. LOBES says how.

#import shared/lpv_lattice
#constant LOBES = 0

const SQUARED = 0u;
const TWO_BANDS = 1u;
// Length of the mean direction at which a lobe ends at a right angle.
const MOST_DIRECTED = 0.75;

// Energy towards a neighbour of a kind, over its share of all directions.
fn towards(lobe: vec4f, direction: vec3f, kind: u32) -> f32 {
    if LOBES == TWO_BANDS {
        return lobe.w + 3.0 * kept_direction(kind) * dot(lobe.xyz, direction);
    }
    let root = max(lobe.w + dot(lobe.xyz, direction), 0.0);
    return root * root;
}

// Mean cosine, with the way to a neighbour, of light that has gone there.
fn kept_direction(kind: u32) -> f32 {
    if LOBES == TWO_BANDS {
        return 1.0 - SHARES[kind];
    }
    return 1.0;
}

// Energy towards all neighbours of each kind together, in the sum over which the second band is nothing.
fn by_kind(lobe: vec4f) -> vec3f {
    if LOBES == TWO_BANDS {
        return COUNTS * SHARES * lobe.w;
    }
    var sums = vec3f(0.0);
    for (var number = 0u; number < 27u; number++) {
        if number != LINKS {
            let offset = neighbour(number);
            let kind = kind_of(offset);
            sums[kind] += SHARES[kind] * towards(lobe, normalize(vec3f(offset)), kind);
        }
    }
    return sums;
}

// Flux and, last, energy.
fn moments(lobe: vec4f) -> vec4f {
    if LOBES == TWO_BANDS {
        return lobe;
    }
    var sum = vec4f(0.0);
    for (var number = 0u; number < 27u; number++) {
        if number != LINKS {
            let offset = neighbour(number);
            let kind = kind_of(offset);
            let direction = normalize(vec3f(offset));
            sum += vec4f(direction, 1.0) * (SHARES[kind] * towards(lobe, direction, kind));
        }
    }
    return sum;
}

// `v` and, last, `p` of `max(0, p + v . w)^2`, or the first two bands, from flux and energy.
fn lobe(flux: vec3f, energy: f32) -> vec4f {
    if LOBES == TWO_BANDS {
        return vec4f(flux, energy);
    }
    if energy <= 0.0 {
        return vec4f(0.0);
    }
    let size = length(flux);
    let directed = min(size / max(energy, 1e-30), MOST_DIRECTED);
    let root = sqrt(max(1.0 - 3.0 * directed * directed, 0.0));
    let is_wide = directed < 0.5;
    let p = select(3.0 - 4.0 * directed, 1.0 + root, is_wide);
    let v = select(1.0, 3.0 * directed, is_wide);
    let shape = vec4f(flux * (v / max(size, 1e-30)), p);
    let all = by_kind(shape);
    return shape * sqrt(energy / (all.x + all.y + all.z));
}
