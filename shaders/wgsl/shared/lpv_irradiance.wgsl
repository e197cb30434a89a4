// Light of a volume at points between the middles of cells. Passes bind `shown`, [3, cells]: flux and energy times
// lengths of ways, watts times cells.

struct Fluence {
    // Of red, green and blue in columns, watts for each square metre.
    flux: mat3x3f,
    // Over all directions.
    all: vec3f,
}

fn fluence_of_cell(at: vec3i) -> Fluence {
    let cells = cell_count();
    let index = cell_index(at);
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
    let at = clamp(in_cells(point) - 0.5, vec3f(0.0), grid.size.xyz - 1.0);
    let low = min(floor(at), max(grid.size.xyz - 2.0, vec3f(0.0)));
    return Taps(vec3i(low), at - low);
}

fn tap_weight(taps: Taps, corner: vec3i) -> f32 {
    let weights = select(1.0 - taps.part, taps.part, corner == vec3i(1));
    return weights.x * weights.y * weights.z;
}

// Irradiance of light of a lobe: with the cosine the means of 1, w and w w^T over the sphere are 1/4, -n / 6 and (1 + n
// n^T) / 16.
fn lobe_irradiance(lobe: vec4f, normal: vec3f) -> f32 {
    let along = dot(lobe.xyz, normal);
    return 0.25 * lobe.w * lobe.w - lobe.w * along / 3.0 + (dot(lobe.xyz, lobe.xyz) + along * along) / 16.0;
}

// Irradiance on one side of a surface, of cells whose middle it sees: what is behind it does not light it.
fn irradiance(point: vec3f, normal: vec3f) -> vec3f {
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
        let light = fluence_of_cell(at);
        for (var c = 0u; c < 3u; c++) {
            sum[c] += weight * lobe_irradiance(lobe(light.flux[c], light.all[c]), normal);
        }
        weights += weight;
    }
    return sum / (weights * grid.low.w * grid.low.w);
}

// What a cell behind a surface counts at least, so that there is some.
const LEAST_SEEN = 1e-3;
