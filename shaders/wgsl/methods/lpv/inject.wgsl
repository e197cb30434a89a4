// Surfels as light that they reflect of the lamps, and as blockers: render/src/lpv/injection.rs.

#import shared/lpv_blockers
#import shared/lpv_grid
#import shared/lpv_lattice
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
// [cubes, 17]: of a cell and each link of which it is the first the share of the link's tube that surfaces
// cover; of a cube `sum A colour / s^2` and `sum A / s^2`: render/src/lpv/blockers.rs
@group(0) @binding(6) var<storage, read_write> blockers: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> patches: array<Patch>;
@group(0) @binding(8) var<storage, read> starts: array<u32>;

fn add_blocker(index: u32, share: f32) {
    atomicAdd(&blockers[index], u32(share * BLOCKER_ONE + 0.5));
}

// The cell from which the link of an offset goes whose tube a surface lies in; of the place the middles of
// cells are whole numbers.
fn first_cell(at: vec3f, normal: vec3f, offset: vec3i) -> vec3i {
    let way = vec3f(offset);
    let facing = abs(normal) * abs(way) + 1e-6 * abs(way);
    var axis = 0u;
    if facing.y > facing.x && facing.y >= facing.z {
        axis = 1u;
    } else if facing.z > facing.x && facing.z > facing.y {
        axis = 2u;
    }
    let along = at[axis] * way[axis];
    let gone = along - floor(along);
    var first = vec3i(floor(at - gone * way + 0.5));
    first[axis] = i32(floor(along)) * offset[axis];
    return first;
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
    let share = area / (grid.low.w * grid.low.w);
    let at = in_cells(point) - 0.5;
    for (var link = 0u; link < LINKS; link++) {
        let offset = neighbour(LINKS + 1u + link);
        let first = first_cell(at, normal, offset);
        if is_cell(first) {
            add_blocker(BLOCKER_WORDS * cube_index(first) + link, share * abs(dot(normal, vec3f(offset))));
        }
    }
    let cube = vec3i(floor(at + 1.0));
    if all(cube >= vec3i(0)) && all(cube <= vec3i(grid.size.xyz)) {
        let first = BLOCKER_WORDS * cube_index(cube) + LINKS;
        let colour = patch_colour(patches[patch_of(chosen(id.x))]);
        for (var c = 0u; c < 3u; c++) {
            add_blocker(first + c, share * colour[c]);
        }
        add_blocker(first + 3u, share);
    }
}
