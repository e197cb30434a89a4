// What a medium scatters of a lamp's light at one point.

#import shared/light_dimmed
#import shared/lights
#import shared/phase
#import shared/shadow
#import uniforms/light_record

const PI = 3.14159265;

// Radiance that a metre of density 1 sends against `direction`, over its scattering coefficient. What is
// nearer to a lamp than `nearest`, metres, gets what it would there.
fn scattered_of(light: LightRecord, point: vec3f, direction: vec3f, nearest: f32) -> vec3f {
    let arrived = arrival(light, point);
    if all(arrived.irradiance == vec3f(0.0)) {
        return vec3f(0.0);
    }
    let squared = arrived.distance * arrived.distance;
    let bounded_share = select(1.0, squared / max(squared, nearest * nearest), arrived.distance > 0.0);
    // A point of a medium has no surface to be lifted off.
    let shown = lit_share(light, point, vec3f(0.0), arrived.direction) * passed_share(point, arrived);
    return arrived.irradiance * shown * (bounded_share * phase(dot(arrived.direction, direction)));
}
