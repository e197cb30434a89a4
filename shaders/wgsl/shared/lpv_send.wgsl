// What surfels send into cells. Light begins in the cell before its surfel, half a cell along its normal, so
// that it lies before what blocks; directed as Lambert's cosine is on average. Sums are in 64 bits of which
// 40 are behind the point, so that their order does not matter: render/src/lpv/injection.rs. Passes bind
// `grid` and `light`, [cells, 3, 4, 2]: flux and energy of each colour, watts over the area of a cell's face,
// so that what they hold does not hang on the scene's size.

#import shared/lpv_grid

// Mean cosine of light that a matte surface sends.
const DIRECTED = 2.0 / 3.0;

struct Fixed {
    low: u32,
    high: u32,
}

fn fixed_of(value: f32) -> Fixed {
    let scaled = min(abs(value), 0x1p22) * 0x1p8;
    let high = floor(scaled);
    let it = Fixed(u32((scaled - high) * 0x1p32), u32(high));
    if value >= 0.0 {
        return it;
    }
    // The negative of both words, so that what is small is lost of no sign more than of the other.
    return Fixed(~it.low + 1u, ~it.high + select(0u, 1u, it.low == 0u));
}

fn add_light(index: u32, value: f32) {
    let it = fixed_of(value);
    let before = atomicAdd(&light[2u * index], it.low);
    atomicAdd(&light[2u * index + 1u], it.high + select(0u, 1u, before + it.low < before));
}

fn send(point: vec3f, normal: vec3f, power: vec3f) {
    let at = vec3i(floor(in_cells(point) + 0.5 * normal));
    if !is_cell(at) || all(power == vec3f(0.0)) {
        return;
    }
    let first = 12u * cell_index(at);
    let even = power / (grid.low.w * grid.low.w);
    for (var c = 0u; c < 3u; c++) {
        for (var axis = 0u; axis < 3u; axis++) {
            add_light(first + 4u * c + axis, DIRECTED * even[c] * normal[axis]);
        }
        add_light(first + 4u * c + 3u, even[c]);
    }
}
