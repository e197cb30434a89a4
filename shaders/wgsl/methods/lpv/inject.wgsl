// Surfels as light and as blockers. Light that a surfel reflects begins in the cell before it, half a cell along its
// normal, so that it lies before what blocks; directed as Lambert's cosine is on average. Sums are in fixed point, so
// that their order does not matter: render/src/lpv/injection.rs.

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> totals: Totals;
@group(0) @binding(3) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(4) var<storage, read> sent: array<vec2u>;
// [cells, 3, 4, 2]: flux and energy of each colour, watts
@group(0) @binding(5) var<storage, read_write> light: array<atomic<u32>>;
// [cubes, 9, 2]: xx, yy, zz, xy, xz and yz of `sum A n n^T / s^2`; `sum A colour / s^2`
@group(0) @binding(6) var<storage, read_write> cubes: array<atomic<u32>>;

@group(0) @binding(7) var<storage, read> patches: array<Patch>;
@group(0) @binding(8) var<storage, read> starts: array<u32>;

// Mean cosine of light that a matte surface sends.
const DIRECTED = 2.0 / 3.0;

struct Fixed {
    low: u32,
    high: u32,
}

fn fixed_of(value: f32) -> Fixed {
    let scaled = clamp(value, -0x1p22, 0x1p22) * 0x1p8;
    let high = floor(scaled);
    return Fixed(u32((scaled - high) * 0x1p32), bitcast<u32>(i32(high)));
}

fn add_light(index: u32, value: f32) {
    let it = fixed_of(value);
    let before = atomicAdd(&light[2u * index], it.low);
    atomicAdd(&light[2u * index + 1u], it.high + select(0u, 1u, before + it.low < before));
}

fn add_blocker(index: u32, value: f32) {
    let it = fixed_of(value);
    let before = atomicAdd(&cubes[2u * index], it.low);
    atomicAdd(&cubes[2u * index + 1u], it.high + select(0u, 1u, before + it.low < before));
}

fn send(point: vec3f, normal: vec3f, power: vec3f) {
    let at = vec3i(floor(in_cells(point) + 0.5 * normal));
    if !is_cell(at) || all(power == vec3f(0.0)) {
        return;
    }
    let first = 12u * cell_index(at);
    for (var c = 0u; c < 3u; c++) {
        for (var axis = 0u; axis < 3u; axis++) {
            add_light(first + 4u * c + axis, DIRECTED * power[c] * normal[axis]);
        }
        add_light(first + 4u * c + 3u, power[c]);
    }
}

@compute @workgroup_size(64)
fn inject(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let surfel = surfels[id.x];
    let point = view.eye.xyz + from_view(surfel.place, view);
    let normal = from_view(surfel_normal(surfel), view);
    let radius = surfel_radius(surfel);
    let area = PI * radius * radius;
    send(point, normal, PI * area * unpack_radiance(sent[id.x].x));
    send(point, -normal, PI * area * unpack_radiance(sent[id.x].y));
    let cube = vec3i(floor(in_cells(point) + 0.5));
    if all(cube >= vec3i(0)) && all(cube <= vec3i(grid.size.xyz)) {
        let first = 9u * cube_index(cube);
        let share = area / (grid.low.w * grid.low.w);
        let colour = patch_colour(patches[patch_of(chosen(id.x))]);
        for (var axis = 0u; axis < 3u; axis++) {
            add_blocker(first + axis, share * normal[axis] * normal[axis]);
            add_blocker(first + 6u + axis, share * colour[axis]);
            // xy, xz, yz.
            let product = normal[select(0u, 1u, axis == 2u)] * normal[select(2u, 1u, axis == 0u)];
            add_blocker(first + 3u + axis, share * product);
        }
    }
}
