// A direction around a normal, which a place on the disk leads to: its radius squared, and its angle, turns.
// Lifted onto the hemisphere the place has the density cosine / pi (Malley's method).

#import shared/tangents

fn cosine_direction(normal: vec3f, place: vec2f) -> vec3f {
    let angle = 6.2831853 * place.y;
    let across = sqrt(place.x) * vec2f(cos(angle), sin(angle));
    return tangents(normal) * vec3f(across, sqrt(1.0 - place.x));
}
