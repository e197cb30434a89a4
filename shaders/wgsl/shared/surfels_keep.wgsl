// Light that patches keep: their states, moved on by a stretch of time under the lamps as they are now, at
// their middles. The plain version is render/src/path/phosphor/afterglow.rs.

#import shared/glow_change
#import shared/glow_keeper
#import shared/glow_place
#import shared/glow_time
#import shared/surfel_patch_record
#import uniforms/frame_view
#import uniforms/light_record
#import uniforms/paint_state
#constant LIGHTS = 1
#constant PAINT_STATES = 1
#constant SCHEDULES = 1

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(1) var<storage, read> patches: array<Patch>;
// [patches, KEEPER_WORDS]: the paint, counted from 1, 0 where no light is kept; factors.
@group(0) @binding(2) var<storage, read> painted: array<u32>;
@group(0) @binding(3) var<storage, read> posed: array<f32>;
@group(0) @binding(4) var<storage, read> time: array<f32>;
@group(0) @binding(5) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(6) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(7) var<storage, read> pictures: array<u32>;
@group(0) @binding(8) var maps: texture_depth_2d_array;
@group(0) @binding(9) var map_sampler: sampler_comparison;
// [2, patches, STATES]
@group(0) @binding(10) var<storage, read_write> states: array<f32>;

@compute @workgroup_size(64)
fn keep(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    let at = index * KEEPER_WORDS;
    if at >= arrayLength(&painted) || painted[at] == 0u {
        return;
    }
    var factors = vec4f(1.0);
    if KEEPER_WORDS > 1u {
        factors = keeper_factors(painted[at + 1u], painted[at + 2u]);
    }
    let one = patches[index];
    let weights = patch_weights(one.part) * vec3f(1.0 / 3.0);
    let place = place_of(vec3u(one.corners[0], one.corners[1], one.corners[2]), weights);
    var irradiance: array<vec3f, SCHEDULES>;
    for (var i = 0u; i < LIGHTS; i++) {
        irradiance[schedule_of(i)] += received(lights[i], place);
    }
    move_on(index, painted[at] - 1u, factors, &irradiance, groups.z - 1u);
}
