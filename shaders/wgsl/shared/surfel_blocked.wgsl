// What a surfel takes from a point of the environment's light, irradiance over pi: the radiance from behind
// its middle times its form factor.

#import shared/environment
#import shared/environment_height
#import shared/surfel_form_factor
#import shared/surfel_receiver
#import shared/view
#import uniforms/frame_view

@group(0) @binding(8) var<uniform> view: FrameView;
// Each direction's texel its mean radiance.
@group(0) @binding(9) var<storage, read> environment: array<vec4f>;

fn added(sum: vec3f, which: u32, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    let share = form_factor(surfels[which], way, squared, receiver.normal);
    if share == 0.0 {
        return sum;
    }
    return sum + share * environment_radiance(0u, environment_height(), normalize(from_view(way, view)));
}
