// How far a surfel does something, but for a factor that is the same for all: its radius, if it sends light.
fn effect_distance(surfel: Surfel) -> f32 {
    return select(0.0, surfel.place.w, (surfel.front | surfel.back) << 5u != 0u);
}
