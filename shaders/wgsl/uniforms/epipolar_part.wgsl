/// Which of the lines' parts, one after the other, a pass of `methods/epipolar` is of.
struct EpipolarPart {
    /// Its number.
    number: u32,
}
