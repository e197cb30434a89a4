// What both sides of surfels emit, W/m²/sr. What the back of a closed body's surface emits stays in it.

#import shared/packing
#import shared/surfel_order
#import shared/surfel_record

// Of patches: emitted radiance, packed.
@group(0) @binding(4) var<storage, read> emissions: array<u32>;
@group(0) @binding(7) var<storage, read> starts: array<u32>;

fn own_radiance(number: u32, surfel: Surfel) -> mat2x3f {
    let front = unpack_radiance(emissions[patch_of(chosen(number))]);
    return mat2x3f(front, select(vec3f(0.0), front, surfel_is_open(surfel)));
}
