// What surfels emit, by itself or, if it ADDS, beside what they send.

#import shared/packing
#import shared/surfel
#import shared/surfel_order
#import shared/surfel_record
#constant ADDS = 1

@group(0) @binding(0) var<storage, read> totals: Totals;
@group(0) @binding(1) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
// Of patches: emitted radiance, packed.
@group(0) @binding(3) var<storage, read> emissions: array<u32>;
// Of front and back, as `surfels/light` has written it.
@group(0) @binding(4) var<storage, read_write> sent: array<vec2u>;

@compute @workgroup_size(64)
fn emit(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let emitted = unpack_radiance(emissions[patch_of(chosen(id.x))]);
    // What the back of a closed body's surface emits stays in it.
    let behind = select(vec3f(0.0), emitted, surfel_is_open(surfels[id.x]));
    if ADDS == 0u {
        sent[id.x] = vec2u(pack_radiance(emitted), pack_radiance(behind));
        return;
    }
    let both = sent[id.x];
    sent[id.x] = vec2u(
        pack_radiance(unpack_radiance(both.x) + emitted),
        pack_radiance(unpack_radiance(both.y) + behind),
    );
}
