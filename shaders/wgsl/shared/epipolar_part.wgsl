// Lines in parts for which there is room. The last line of a part is the first of the next, so that both
// lines beside a pixel are in one. Passes bind `epipolar`.

#import uniforms/epipolar_part

@group(0) @binding(14) var<uniform> part: EpipolarPart;

// The number of a part's first line.
fn first_line() -> u32 {
    return part.number * (epipolar.lines - 1u);
}
