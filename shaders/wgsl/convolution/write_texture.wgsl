// Writes the network's image into a texture: channels that it has not are 0, and opaque.

#import shared/net_window

@group(0) @binding(3) var made: Target;

fn activate(sums: ptr<function, Sums>) {}

fn store_vector(at: vec2<i32>, block: u32, value: vec4<f32>) {
    let pixel = image_pixel(at);
    if (kept(pixel)) {
        textureStore(made, pixel, vec4(value.xyz, select(1.0, value.w, layer.channels > 3u)));
    }
}
