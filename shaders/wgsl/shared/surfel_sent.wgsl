// What surfels send: radiance on the side of the normal and on the other, as `surfels/light` has written it.

#import shared/packing
#import shared/surfel_record

@group(0) @binding(8) var<storage, read> sent: array<vec2u>;

// The radiance that a surfel sends against a way to it.
fn surfel_sent(which: u32, way: vec3f) -> vec3f {
    let is_behind = dot(way, surfel_normal(surfels[which])) >= 0.0;
    return unpack_radiance(select(sent[which].x, sent[which].y, is_behind));
}
