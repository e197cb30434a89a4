// The bound of a loop, from a uniform. lavapipe (Mesa 22.3) compiles a shader anew for every dispatch where a
// uniform alone bounds a loop, and keeps what it made; of a bound that names the pixel it cannot know that it
// is the uniform. The pixel comes first: where the uniform does, in a binding after several others, it
// crashes.
fn bounded(count: u32, pixel: vec2u) -> u32 {
    return min(0xffffu + pixel.x, count);
}
