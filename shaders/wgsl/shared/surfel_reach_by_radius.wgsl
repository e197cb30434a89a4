// How far a surfel does something, but for a factor that is the same for all: its radius.
fn effect_distance(surfel: Surfel) -> f32 {
    return surfel.place.w;
}
