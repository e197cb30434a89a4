// Light of a volume at points between the middles of cells. Passes bind `shown`, [planes, 3, cells]: flux and
// energy times lengths of ways, watts times cells, first as the medium shows it. Where NESTED is 1 cells at
// the border are not looked at: what a coarser grid hands over in them is not all of their light.

#import shared/lpv_grid
#constant LOOKUP = 0
#constant NESTED = 1

struct Fluence {
    // Of red, green and blue in columns, watts for each square metre.
    flux: mat3x3f,
    // Over all directions.
    all: vec3f,
}

fn fluence_of_cell(at: vec3i, plane: u32) -> Fluence {
    let cells = cell_count();
    let index = cell_index(at) + 3u * plane * cells;
    let red = shown[index];
    let green = shown[index + cells];
    let blue = shown[index + 2u * cells];
    return Fluence(mat3x3f(red.xyz, green.xyz, blue.xyz), vec3f(red.w, green.w, blue.w));
}

struct Taps {
    low: vec3i,
    part: vec3f,
}

fn taps(point: vec3f) -> Taps {
    let unseen = vec3f(f32(NESTED));
    let at = clamp(in_cells(point) - 0.5, unseen, grid.size.xyz - 1.0 - unseen);
    let low = min(floor(at), max(grid.size.xyz - 2.0, vec3f(0.0)));
    return Taps(vec3i(low), at - low);
}

fn tap_weight(taps: Taps, corner: vec3i) -> f32 {
    let weights = select(1.0 - taps.part, taps.part, corner == vec3i(1));
    return weights.x * weights.y * weights.z;
}

// Irradiance of light of a flux and an energy: of a lobe of these the bands of the clamped cosine up to the
// second.
fn lobe_irradiance(flux: vec3f, energy: f32, normal: vec3f) -> f32 {
    let size = length(flux);
    let directed = min(size / max(energy, 1e-30), 1.0);
    let root = sqrt(max(1.0 - 3.0 * directed * directed, 0.0));
    let rest = 4.0 * (1.0 - directed);
    // The mean of (3 x^2 - 1) / 2.
    let second =
        select(1.0 - 0.75 * rest + 0.15 * rest * rest, 0.6 * directed * directed / (1.0 + root), directed < 0.5);
    let along = dot(flux, normal) / max(size, 1e-30);
    let share = 0.25 - 0.5 * directed * along + 0.15625 * second * (3.0 * along * along - 1.0);
    return max(share, 0.0) * max(energy, 0.0);
}

const BEFORE = 0u;
const WITHIN = 1u;

// Irradiance of the light of one cell.
fn irradiance_of_cell(at: vec3i, plane: u32, normal: vec3f) -> vec3f {
    let light = fluence_of_cell(at, plane);
    return vec3f(
        lobe_irradiance(light.flux[0], light.all[0], normal),
        lobe_irradiance(light.flux[1], light.all[1], normal),
        lobe_irradiance(light.flux[2], light.all[2], normal),
    ) / (grid.low.w * grid.low.w);
}

// Irradiance on one side of a surface, of cells whose middle it sees: what is behind it does not light it.
fn irradiance(point: vec3f, normal: vec3f, plane: u32) -> vec3f {
    if LOOKUP == WITHIN {
        let unseen = vec3i(i32(NESTED));
        let at = clamp(vec3i(floor(in_cells(point))), unseen, vec3i(grid.size.xyz) - 1 - unseen);
        return irradiance_of_cell(at, plane, normal);
    }
    let lifted = point + 0.5 * grid.low.w * normal;
    let around = taps(lifted);
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 8; i++) {
        let corner = vec3i(i & 1, (i >> 1u) & 1, i >> 2u);
        let at = min(around.low + corner, vec3i(grid.size.xyz) - 1);
        let middle = grid.low.xyz + grid.low.w * (vec3f(at) + 0.5);
        let before = clamp(dot(middle - point, normal) / (0.25 * grid.low.w), 0.0, 1.0);
        let weight = tap_weight(around, corner) * max(before, LEAST_SEEN);
        sum += weight * irradiance_of_cell(at, plane, normal);
        weights += weight;
    }
    return sum / weights;
}

// What a cell behind a surface counts at least, so that there is some.
const LEAST_SEEN = 1e-3;
