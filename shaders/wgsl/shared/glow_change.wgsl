// A share and what rounding leaves of its changes.

struct Share {
    value: f32,
    left: f32,
}

// A share and a change, with what rounding leaves (Kahan 1965): the changes of slow states in a frame are smaller than what can
// be told from their shares. `nothing` is 0, which compilers do not know: they would take (a + b) - a for b.
fn changed(share: Share, change: f32, nothing: u32) -> Share {
    let wanted = change + share.left;
    let sum = bitcast<f32>(bitcast<u32>(share.value + wanted) ^ nothing);
    let value = clamp(sum, 0.0, 1.0);
    return Share(value, select(0.0, wanted - (sum - share.value), value == sum));
}
