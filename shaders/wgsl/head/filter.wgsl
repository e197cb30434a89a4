// The image of a network that predicts kernels (Bako et al. 2017, over several resolutions after Vogels et
// al. 2018): the light, weighted by the softmax of what the last block makes. Of what a tile keeps.

#import head/pyramid

// What is subtracted before powers are taken, so that none overflows.
fn largest(pixel: vec2<u32>) -> f32 {
    var most = made_by_net(0u, pixel);
    for (var tap = 1u; tap < LEVELS * AREA + BLACK; tap++) {
        most = max(most, made_by_net(tap, pixel));
    }
    return most;
}

fn image_at(pixel: vec2<u32>) -> vec4<f32> {
    let most = largest(pixel);
    var light = vec4(0.0);
    var weights = 0.0;
    if (BLACK == 1u) {
        weights = exp(made_by_net(LEVELS * AREA, pixel) - most);
    }
    var first = 0u;
    for (var index = 0u; index < LEVELS; index++) {
        let level = level_at(index, first, pixel);
        for (var tap = 0u; tap < AREA; tap++) {
            let weight = exp(made_by_net(index * AREA + tap, pixel) - most);
            light += weight * between(level, offset_of(tap));
            weights += weight;
        }
        first += CHANNELS * u32(level.size.x * level.size.y);
    }
    return light / weights;
}
