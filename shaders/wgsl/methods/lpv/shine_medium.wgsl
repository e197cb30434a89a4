// Light that the medium in each cell gives back of what it kept, alike in all directions: as much radiance
// where nothing is seen through it as a surface of its paint has: render/src/lpv/injection.rs.

#import shared/glow_cells
#import shared/lpv_grid
#import shared/lpv_part
#import shared/lpv_send
#import shared/medium
#import uniforms/glow_cells
#import uniforms/light_grid
#import uniforms/medium_record
#import uniforms/paint_state
#constant PAINT_STATES = 1

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(2) var<uniform> lattice: GlowCells;
@group(0) @binding(3) var<uniform> medium: MediumRecord;
// [2, cells of the lattice, STATES]: shares, and what rounding has left of their changes
@group(0) @binding(4) var<storage, read> states: array<f32>;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(5) var<storage, read_write> light: array<atomic<u32>>;
@group(0) @binding(6) var densities: texture_3d<f32>;

const PI = 3.14159265;

@compute @workgroup_size(64)
fn shine(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    let part = part_in_medium(cell_at(id.x));
    var sent = vec3f(0.0);
    for (var i = 0; i < 8; i++) {
        let point = part_point(part, i);
        sent += density_inside(point) * sent_at(point);
    }
    // Over the area of a cell's face. What scatters light sends none of its own.
    let even = sent * (medium.extinction.rgb - medium.scattering.rgb) * (0.5 * PI * share_of(part) * grid.low.w);
    for (var c = 0u; c < 3u; c++) {
        add_light(12u * id.x + 4u * c + 3u, even[c]);
    }
}
