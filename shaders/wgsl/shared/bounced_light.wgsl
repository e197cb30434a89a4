// The radiance that surfels send, on the side that is met.

#import shared/bounced_none
#import shared/packing

// Of the front and of the back, as `surfels/light` has written it.
@group(0) @binding(1) var<storage, read> sent: array<vec2u>;

fn arriving(met: u32) -> vec3f {
    if met == NONE {
        return vec3f(0.0);
    }
    return unpack_radiance(sent[met >> 1u][met & 1u]);
}
