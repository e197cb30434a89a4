// How far a surfel does something, but for a factor that is the same for all: its radius.
#import shared/surfel_record

fn effect_distance(which: u32) -> f32 {
    return surfel_radius(surfels[which]);
}
