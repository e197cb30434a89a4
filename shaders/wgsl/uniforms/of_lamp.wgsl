/// Which lamp a pass is of.
struct OfLamp {
    /// Its number.
    number: u32,
}
