// Writes a pixel into a texture: channels that the image has not are 0, and opaque.

@group(0) @binding(3) var made: Target;

fn store(pixel: vec2<u32>, value: vec4<f32>) {
    textureStore(made, pixel, vec4(value.xyz, select(1.0, value.w, CHANNELS > 3u)));
}
