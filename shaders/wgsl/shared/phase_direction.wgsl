// A direction after scattering of what travelled in a unit direction, by the phase function of Henyey and
// Greenstein 1941, from two uniform numbers. The inverse of the cumulated density is multiplied out, so that
// light scattered alike in all directions is no exception. Passes bind `medium`.

#import shared/tangents

fn phase_direction(direction: vec3f, at: vec2f) -> vec3f {
    let g = medium.scattering.w;
    let s = 2.0 * at.x - 1.0;
    let base = 1.0 + g * s;
    let turned = 2.0 * s + g * (s * s + 3.0) + 2.0 * g * g * s + g * g * g * (s * s - 1.0);
    let cosine = clamp(turned / (2.0 * base * base), -1.0, 1.0);
    let sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    let angle = 6.2831853 * at.y;
    return tangents(direction) * vec3f(sine * vec2f(cos(angle), sin(angle)), cosine);
}
