// The interleaved framebuffer (thesis 4.2.2): on level l each square of 2^l x 2^l pixels gives one pixel to
// each of as many sub-buffers, a random one. Nothing is moved: the pixel of a place in a sub-buffer is
// computed.

#import shared/random

// A number below 4^level for each, all different: a bijection for each key.
fn permuted(number: u32, level: u32, key: u32) -> u32 {
    let mask = (1u << (2u * level)) - 1u;
    var it = (number ^ key) & mask;
    it = (it * ((key >> 8u) | 1u)) & mask;
    it ^= it >> max(level, 1u);
    it = (it * ((key >> 16u) | 1u)) & mask;
    return it ^ (it >> max(level, 1u));
}

// The pixel that has this place in a sub-buffer.
fn interleaved_pixel(sub_buffer: u32, place: vec2u, level: u32, seed: u32) -> vec2u {
    let key = hash(place.x + hash(place.y + hash(level + hash(seed))));
    let part = permuted(sub_buffer, level, key);
    let mask = (1u << level) - 1u;
    return (place << vec2u(level)) + vec2u(part & mask, part >> level);
}

// The number of a pixel among those of its square of 2^level x 2^level, in a random order that is the
// square's own.
fn number_in_square(pixel: vec2u, level: u32, seed: u32) -> u32 {
    let place = pixel >> vec2u(level);
    let inside = pixel & vec2u((1u << level) - 1u);
    return permuted(inside.x | (inside.y << level), level, hash(place.x + hash(place.y + hash(level + hash(seed)))));
}
