/// From where a raster pass looks: `shared/view.wgsl`.
struct FrameView {
    /// Where the eye is, world space, metres.
    eye: vec4f,
    /// To the right in the image, unit vector in world space.
    right: vec4f,
    /// Up in the image.
    up: vec4f,
    /// Against the direction of sight.
    back: vec4f,
    /// Half images to the right per metre, at depth 1 where it is a perspective.
    scale_x: f32,
    /// Half images up.
    scale_y: f32,
    /// Nearest depth that is seen in perspective, metres.
    near: f32,
    /// Farthest depth that is seen in parallel projection, metres.
    far: f32,
    /// 1 in perspective, 0 in parallel projection.
    perspective: u32,
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
    /// Depth of the plane in focus, metres; 0 without a lens.
    focus: f32,
    /// Radius of the circle of confusion of what is infinitely far away, pixels.
    blur: f32,
    /// Fills up.
    padding_0: f32,
    /// Fills up.
    padding_1: f32,
}
