// States of all texels, moved on by a stretch of time under the lamps as they are now. The plain version is
// render/src/methods/phosphor/reference.rs.

#import shared/glow_change
#import shared/glow_keeper
#import shared/glow_place
#import shared/glow_tile
#import shared/glow_time
#import uniforms/frame_view
#import uniforms/glow_tile
#import uniforms/light_record
#import uniforms/paint_state
#constant LIGHTS = 1
#constant PAINT_STATES = 1
#constant SCHEDULES = 1

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(1) var<storage, read> tiles: array<GlowTile>;
// [texels, KEEPER_WORDS]: the tile that each is part of, and factors
@group(0) @binding(2) var<storage, read> owners: array<u32>;
@group(0) @binding(3) var<storage, read> posed: array<f32>;
@group(0) @binding(4) var<storage, read> time: array<f32>;
@group(0) @binding(5) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(6) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(7) var<storage, read> pictures: array<u32>;
@group(0) @binding(8) var maps: texture_depth_2d_array;
@group(0) @binding(9) var map_sampler: sampler_comparison;
// [2, texels, STATES]: shares, and what rounding has left of their changes
@group(0) @binding(10) var<storage, read_write> states: array<f32>;

// The weights of the corners of a tile's texel.
fn texel_weights(texel: u32, divisions: u32) -> vec3f {
    let wide = f32(2u * divisions + 3u);
    var row = u32(max(0.5 * (wide - sqrt(max(wide * wide - 8.0 * f32(texel), 0.0))), 0.0));
    // The root is rounded.
    if row_start(row, divisions) > texel {
        row -= 1u;
    }
    if row_start(row + 1u, divisions) <= texel {
        row += 1u;
    }
    let place = vec2f(f32(texel - row_start(row, divisions)), f32(row)) / f32(divisions);
    let inwards = drawn_in(divisions);
    let weights = place * (1.0 - inwards) + inwards / 3.0;
    return vec3f(1.0 - weights.x - weights.y, weights);
}

@compute @workgroup_size(64)
fn step_states(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let texel = id.x + id.y * groups.x * 64u;
    let at = texel * KEEPER_WORDS;
    if at >= arrayLength(&owners) {
        return;
    }
    let tile = tiles[owners[at]];
    var factors = vec4f(1.0);
    if KEEPER_WORDS > 1u {
        factors = keeper_factors(owners[at + 1u], owners[at + 2u]);
    }
    let place = place_of(tile_vertices(tile), texel_weights(texel - tile.first, tile.divisions));
    var irradiance: array<vec3f, SCHEDULES>;
    for (var i = 0u; i < LIGHTS; i++) {
        irradiance[schedule_of(i)] += received(lights[i], place);
    }
    move_on(texel, tile.paint, factors, &irradiance, groups.z - 1u);
}
