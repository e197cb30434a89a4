// From where a raster pass looks: a camera, a light's map or a cascade. Directions and offsets from the eye are in world
// axes; depth is along the axis of sight, and depth buffers hold near / depth (perspective) or 1 - depth / far
// (parallel), so that what is near is large.

#import uniforms/frame_view

fn to_view(offset: vec3f, view: FrameView) -> vec3f {
    return vec3f(dot(offset, view.right.xyz), dot(offset, view.up.xyz), dot(offset, view.back.xyz));
}

fn clip_position(offset: vec3f, view: FrameView) -> vec4f {
    let at = to_view(offset, view);
    let across = vec2f(at.x * view.scale_x, at.y * view.scale_y);
    let perspective = vec4f(across, view.near, -at.z);
    return select(vec4f(across, 1.0 + at.z / view.far, 1.0), perspective, view.perspective == 1u);
}

// Where an offset from the eye is in the image, pixels from its middle, y up.
fn in_image(offset: vec3f, view: FrameView) -> vec2f {
    let clip = clip_position(offset, view);
    return 0.5 * clip.xy / clip.w * vec2f(f32(view.width), f32(view.height));
}

// The depth that a value of the depth buffer stands for.
fn depth_of(stored: f32, view: FrameView) -> f32 {
    if view.perspective == 1u {
        return view.near / stored;
    }
    return (1.0 - stored) * view.far;
}

// Where, in view space, a point of the image at some depth is; `pixel` from the top left corner.
fn view_position(pixel: vec2f, depth: f32, view: FrameView) -> vec3f {
    let ndc = vec2f(2.0 * pixel.x / f32(view.width) - 1.0, 1.0 - 2.0 * pixel.y / f32(view.height));
    let across = vec2f(ndc.x / view.scale_x, ndc.y / view.scale_y);
    if view.perspective == 1u {
        return vec3f(across * depth, -depth);
    }
    return vec3f(across, -depth);
}

// An offset from the eye in world axes.
fn from_view(at: vec3f, view: FrameView) -> vec3f {
    return view.right.xyz * at.x + view.up.xyz * at.y + view.back.xyz * at.z;
}
