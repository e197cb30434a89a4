// By how much a surfel faces where a way to its middle comes from: its cosine times the way's length. Of
// closed surfaces only fronts count.
#import shared/surfel_record

fn surfel_facing(surfel: Surfel, way: vec3f) -> f32 {
    let towards = -dot(way, surfel_normal(surfel));
    return select(max(towards, 0.0), abs(towards), surfel_is_open(surfel));
}
