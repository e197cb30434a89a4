// What both sides of surfels give back of light that they kept, W/m²/sr.

#import shared/packing
#import shared/surfel_record
#constant UNIT = 128

// As give_back.wgsl writes it, in 2^(128 - UNIT) W/m²/sr.
@group(0) @binding(4) var<storage, read> kept: array<vec2u>;

fn own_radiance(number: u32, surfel: Surfel) -> mat2x3f {
    let sent = kept[number];
    return exp2(128.0 - f32(UNIT)) * mat2x3f(unpack_radiance(sent.x), unpack_radiance(sent.y));
}
