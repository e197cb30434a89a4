/// What `methods/volume_shell/splat` and `direct` read beside the level.
struct VolumeShell {
    /// Points of a ray's way through the medium at which density was looked up.
    steps: u32,
    /// Surfels nearer than this, metres, do what they would at this distance.
    nearest: f32,
}
