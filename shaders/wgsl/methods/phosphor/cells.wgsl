// States of a medium's cells (thesis, Figure 8.17), moved on by a stretch of time under the lamps as they are
// now: all light of theirs that goes through a cell's middle, dimmed on its way, whatever its direction.

#import shared/glow_change
#import shared/glow_time
#import shared/light_dimmed
#import shared/lights
#import shared/shadow
#import uniforms/frame_view
#import uniforms/glow_cells
#import uniforms/light_record
#import uniforms/paint_state
#constant LIGHTS = 1
#constant PAINT = 0
#constant PAINT_STATES = 1
#constant SCHEDULES = 1

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(1) var<uniform> lattice: GlowCells;
@group(0) @binding(2) var<storage, read> time: array<f32>;
@group(0) @binding(3) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(4) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(5) var<storage, read> pictures: array<u32>;
@group(0) @binding(6) var maps: texture_depth_2d_array;
@group(0) @binding(7) var map_sampler: sampler_comparison;
// [2, cells, STATES]: shares, and what rounding has left of their changes
@group(0) @binding(8) var<storage, read_write> states: array<f32>;

@compute @workgroup_size(64)
fn step_cells(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let cell = id.x + id.y * groups.x * 64u;
    let size = vec3u(lattice.cells.xyz);
    if cell >= size.x * size.y * size.z {
        return;
    }
    let at_cell = vec3f(vec3u(cell % size.x, cell / size.x % size.y, cell / (size.x * size.y)));
    let point = lattice.low.xyz + (at_cell + 0.5) / lattice.cells.xyz * (lattice.high.xyz - lattice.low.xyz);
    var irradiance: array<vec3f, SCHEDULES>;
    for (var i = 0u; i < LIGHTS; i++) {
        let arrived = arrival(lights[i], point);
        let shown = lit_share(lights[i], point, arrived.direction, arrived.direction);
        irradiance[schedule_of(i)] += arrived.irradiance * shown * passed_share(point, arrived);
    }
    move_on(cell, PAINT, vec4f(1.0), &irradiance, groups.z - 1u);
}
