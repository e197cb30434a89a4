// The image of a network whose last block makes it on a coarser level, the pixels of a square as channels.

#import head/pyramid

fn image_at(pixel: vec2<u32>) -> vec4<f32> {
    var image = vec4(0.0);
    for (var c = 0u; c < CHANNELS; c++) {
        image[c] = made_by_net(c, pixel);
    }
    return image;
}
