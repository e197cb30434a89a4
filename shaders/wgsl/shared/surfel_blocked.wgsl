// What a surfel takes from a point of the environment's light, irradiance over pi: the radiance from behind its middle times
// its form factor.

@group(0) @binding(8) var<uniform> view: FrameView;
// A map of BLOCKED_HEIGHT rows.
@group(0) @binding(9) var<storage, read> environment: array<vec4f>;

fn added(sum: vec3f, surfel: Surfel, way: vec3f, squared: f32, receiver: Receiver) -> vec3f {
    let share = form_factor(surfel, way, squared, receiver.normal);
    if share == 0.0 {
        return sum;
    }
    return sum + share * environment_radiance(0u, BLOCKED_HEIGHT, normalize(from_view(way, view)));
}
