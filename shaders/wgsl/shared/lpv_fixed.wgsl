// Sums in 64 bits of which 40 are behind the point, so that their order does not matter. Passes bind `sums`,
// in which a number has its lower word first.

fn fixed_sum(index: u32) -> f32 {
    return f32(bitcast<i32>(sums[2u * index + 1u])) * 0x1p-8 + f32(sums[2u * index]) * 0x1p-40;
}
