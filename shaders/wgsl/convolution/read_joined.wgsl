// Reads the concatenation of two images that is never stored: the coarser level, doubled bilinearly on the
// way (pixel centres at halves, the edge continued outwards), and the same level's layer on the way down.
// Rust binds `coarse` and `skip`.

#import convolution/layer

fn coarse_texel(block: u32, at: vec2<i32>) -> vec4<f32> {
    let size = vec2(layer.width, layer.height) / 2u;
    let pixel = vec2<u32>(clamp(at, vec2(0), vec2<i32>(size) - 1));
    return vec4<f32>(coarse[(block * size.y + pixel.y) * size.x + pixel.x]);
}

// 3/4 the coarse pixel in which a pixel lies and 1/4 the next one on the side towards which it lies, along
// each axis.
fn doubled(block: u32, at: vec2<i32>) -> vec4<f32> {
    let near = at / 2;
    let far = near + select(vec2(-1), vec2(1), at % 2 == vec2(1));
    let upper = 0.75 * coarse_texel(block, near) + 0.25 * coarse_texel(block, vec2(far.x, near.y));
    let lower = 0.75 * coarse_texel(block, vec2(near.x, far.y)) + 0.25 * coarse_texel(block, far);
    return 0.75 * upper + 0.25 * lower;
}

fn texel_of(inputs: Inputs, at: vec2<i32>) -> vec4<f32> {
    if (!inside(at)) {
        return vec4(0.0);
    }
    if (!inputs.skip) {
        return doubled(inputs.block, at);
    }
    return vec4<f32>(skip[(inputs.block * layer.height + u32(at.y)) * layer.width + u32(at.x)]);
}
