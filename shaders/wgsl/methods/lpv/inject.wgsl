// Surfels as light that they reflect of the lamps, and as blockers: render/src/lpv/injection.rs.

#import shared/lpv_grid
#import shared/lpv_send
#import shared/packing
#import shared/surfel
#import shared/surfel_order
#import shared/surfel_patch_record
#import shared/surfel_record
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> totals: Totals;
@group(0) @binding(3) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(4) var<storage, read> sent: array<vec2u>;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(5) var<storage, read_write> light: array<atomic<u32>>;
// [cubes, 9, 2]: xx, yy, zz, xy, xz and yz of `sum A n n^T / s^2`; `sum A colour / s^2`
@group(0) @binding(6) var<storage, read_write> cubes: array<atomic<u32>>;

@group(0) @binding(7) var<storage, read> patches: array<Patch>;
@group(0) @binding(8) var<storage, read> starts: array<u32>;

fn add_blocker(index: u32, value: f32) {
    let it = fixed_of(value);
    let before = atomicAdd(&cubes[2u * index], it.low);
    atomicAdd(&cubes[2u * index + 1u], it.high + select(0u, 1u, before + it.low < before));
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
