// What of a lamp's light the medium lets through to a point.

#import shared/colours
#import shared/lights
#import shared/medium
#import uniforms/medium_record

@group(0) @binding(11) var<uniform> medium: MediumRecord;
@group(0) @binding(12) var densities: texture_3d<f32>;

// Points of a way through a grid at which density is looked up.
const POINTS = 32u;

fn passed_share(point: vec3f, arrived: Arrival) -> vec3f {
    // A directional light is infinitely far away.
    let reach = select(1e30, arrived.distance, arrived.distance > 0.0);
    return exp(-colours(medium.extinction.rgb) * passed_density(point, arrived.direction, reach, POINTS));
}
