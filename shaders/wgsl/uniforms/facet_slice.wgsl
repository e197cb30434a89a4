/// The facets of one run of `methods/aov/occlusion` or `methods/aov/trace`.
struct FacetSlice {
    /// Which of the nodes that are as high as a slice.
    index: u32,
    /// 1 for the last one, after which occlusion is complete; rays do not read it.
    last: u32,
}
