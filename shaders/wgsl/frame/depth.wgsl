// A shadow map: depths alone.

#import shared/view
#import uniforms/frame_view

@group(0) @binding(0) var<uniform> view: FrameView;

@vertex
fn corner(@location(0) position: vec3f) -> @builtin(position) vec4f {
    return clip_position(position - view.eye.xyz, view);
}
