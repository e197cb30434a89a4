// Second moments of light, which three bands alone have (LOBES): render/src/lpv/moments.rs. In a state they
// come last, [kinds, 5, cells], of red, green and blue in one. Passes bind `state`.

#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lobe
#constant LOBES = 0
#constant SCATTERED = 1

const SECONDS = 5u;
// Mean cosine, and mean of Legendre's second polynomial, of light that a matte surface sends.
const MATTE = 2.0 / 3.0;
const MATTE_SECOND = 0.25;

// xx, yy, xy, xz and yz of the mean of `w w^T - 1/3` over light, times its energy, of three colours.
alias Second = array<vec3f, 5>;

fn second_index(light: u32, number: u32, cell: u32) -> u32 {
    return again_index(cell) + (SCATTERED + SECONDS * light + number) * cell_count();
}

// Keeps those of a kind of light in a cell.
fn keep_second(light: u32, cell: u32, second: Second) {
    if LOBES != THREE_BANDS {
        return;
    }
    for (var i = 0u; i < SECONDS; i++) {
        state[second_index(light, i, cell)] = vec4f(second[i], 0.0);
    }
}

// Second moments with light of an energy, about a direction, of a mean of Legendre's second polynomial.
fn with_light(second: Second, energy: vec3f, direction: vec3f, mean: f32) -> Second {
    let of_energy = mean * energy;
    let squares = direction * direction - 1.0 / 3.0;
    return Second(
        second[0] + squares.x * of_energy,
        second[1] + squares.y * of_energy,
        second[2] + direction.x * direction.y * of_energy,
        second[3] + direction.x * direction.z * of_energy,
        second[4] + direction.y * direction.z * of_energy,
    );
}

// Those of light of which flux and, last, energy are known, in columns, as if a matte surface had sent all
// that has a direction.
fn second_begun(light: mat3x4f) -> Second {
    var second: Second;
    for (var c = 0u; c < 3u; c++) {
        let size = length(light[c].xyz);
        let directed = min(size / max(light[c].w, 1e-30), 1.0) / MATTE;
        var energy = vec3f(0.0);
        energy[c] = max(light[c].w, 0.0);
        let mean = MATTE_SECOND * directed * directed;
        second = with_light(second, energy, light[c].xyz / max(size, 1e-30), mean);
    }
    return second;
}

// What they add to energy towards a neighbour of a kind, over its share of all directions.
fn third_band(second: Second, direction: vec3f, kind: u32) -> vec3f {
    let squares = direction * direction;
    let across = direction.x * direction.y * second[2]
        + direction.x * direction.z * second[3]
        + direction.y * direction.z * second[4];
    let along = (squares.x - squares.z) * second[0] + (squares.y - squares.z) * second[1];
    return 7.5 * kept_second(kind) * (along + 2.0 * across);
}
