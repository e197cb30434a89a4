// What surfels send of light that their patches kept (thesis, equation 8.3), in 2^(128 - UNIT) W/m²/sr:
// packed radiance ends at 2^-24, and what is kept for long is fainter. What the inside of a closed body gives
// back stays in it.

#import shared/glow_keeper
#import shared/packing
#import shared/surfel
#import shared/surfel_order
#import shared/surfel_record
#import uniforms/paint_state
#constant PAINT_STATES = 1
#constant STATES = 1
#constant UNIT = 128

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
// As keep.wgsl has them.
@group(0) @binding(1) var<storage, read> painted: array<u32>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
@group(0) @binding(3) var<storage, read> totals: Totals;
@group(0) @binding(4) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(5) var<storage, read> states: array<f32>;
@group(0) @binding(6) var<storage, read_write> sent: array<vec2u>;

@compute @workgroup_size(64)
fn give_back(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let index = patch_of(chosen(id.x));
    var emission = vec3f(0.0);
    let at = index * KEEPER_WORDS;
    if painted[at] > 0u {
        for (var s = 0u; s < STATES; s++) {
            emission += states[index * STATES + s] * paints[(painted[at] - 1u) * STATES + s].emission.rgb;
        }
        if KEEPER_WORDS > 1u {
            emission *= keeper_factors(painted[at + 3u], painted[at + 4u]).rgb;
        }
    }
    let front = pack_radiance(emission * exp2(f32(UNIT) - 128.0));
    sent[id.x] = vec2u(front, select(0u, front, surfel_is_open(surfels[id.x])));
}
