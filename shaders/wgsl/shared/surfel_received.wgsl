// What surfels are known to send by what falls on their front and back, where all of it enters: as white ones
// reflect it, of both sides, since no light falls on the inside of a body; and the object that they are part
// of.
#import shared/packing
#import shared/surfel
#import shared/surfel_patch_record

fn sent_of(front: vec3f, back: vec3f, one: Patch) -> vec2u {
    return vec2u(pack_radiance((front + back) / PI), one.object);
}
