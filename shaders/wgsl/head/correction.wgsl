// The image of a network that corrects an estimate: a bias of each channel or a gain, and a weighted sum of
// how far pixels of a pyramid are from the estimate, within the effect's range. Where it is GATED, nothing is
// corrected where the estimate is what the pyramid is of. Of what a tile keeps.

#import head/pyramid

fn image_at(pixel: vec2<u32>) -> vec4<f32> {
    let whole = level_at(0u, 0u, pixel);
    let begun = texel(whole, vec2<i32>(pixel));
    var image = begun;
    for (var c = 0u; c < BIASES; c++) {
        image[c] += made_by_net(c, pixel);
    }
    var first = CHANNELS * layer.width * layer.height;
    for (var index = 0u; index < LEVELS; index++) {
        let level = level_at(index, first, pixel);
        for (var tap = 0u; tap < AREA; tap++) {
            let weight = made_by_net(BIASES + index * AREA + tap, pixel);
            image += weight * (between(level, offset_of(tap)) - begun);
        }
        first += CHANNELS * u32(level.size.x * level.size.y);
    }
    if GAIN == 1u {
        image += made_by_net(COUNT - 1u, pixel) * begun;
    }
    if GATED == 1u {
        let over = texel(level_at(0u, CHANNELS * layer.width * layer.height, pixel), vec2<i32>(pixel));
        let differences = abs(over - begun);
        let difference = max(max(differences.x, differences.y), max(differences.z, differences.w));
        image = begun + difference / (difference + HALF_GATE) * (image - begun);
    }
    return clamp(image, vec4(LEAST), vec4(MOST));
}
