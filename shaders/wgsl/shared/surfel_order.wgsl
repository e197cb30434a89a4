// Which surfel stands for a part of which patch. Passes bind `totals` and `starts`, where the surfels of
// each patch begin among all that are wanted.

#import shared/random
#import shared/surfel
#constant HEIGHT = 8

// Where the surfels that are wanted begin of which the one of that index stands for all.
fn share_begin(index: u32) -> u32 {
    let room = LEAF << (2u * HEIGHT);
    let rest = ((totals.wanted % room) << 12u) / room;
    return index * (totals.wanted / room) + ((index * rest) >> 12u);
}

// The surfel of all that are wanted which is the one of that index of those for which there is room: a random
// one of its share, since there may be a pattern in them.
fn chosen(index: u32) -> u32 {
    if totals.wanted <= LEAF << (2u * HEIGHT) {
        return index;
    }
    let begin = share_begin(index);
    let count = share_begin(index + 1u) - begin;
    return begin + u32(random(vec2u(index, 0u), 0u, 3u) * f32(count));
}

// The patch of a surfel that is wanted: the last one that begins no later.
fn patch_of(wanted: u32) -> u32 {
    var low = 0u;
    var high = arrayLength(&starts);
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if starts[middle] <= wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}
