// What surfels are known to send by what falls on their front and back: what they reflect diffusely on either
// side.
#import shared/packing
#import shared/surfel
#import shared/surfel_patch_record

fn sent_of(front: vec3f, back: vec3f, one: Patch) -> vec2u {
    let reflected = patch_colour(one) / PI;
    return vec2u(pack_radiance(front * reflected), pack_radiance(back * reflected));
}
