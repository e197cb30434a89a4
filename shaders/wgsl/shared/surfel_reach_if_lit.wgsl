// How far a surfel does something, but for a factor that is the same for all: its radius, if it sends light.

#import shared/surfel_record

@group(0) @binding(3) var<storage, read> sent: array<vec2u>;

fn effect_distance(which: u32) -> f32 {
    let is_lit = ((sent[which].x | sent[which].y) << 5u) != 0u;
    return select(0.0, surfel_radius(surfels[which]), is_lit);
}
