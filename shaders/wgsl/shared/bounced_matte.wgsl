// Surfaces that receive light by its cosine, and look into directions that are spread by it.

#import shared/surface
#import shared/tangents

struct Reflector {
    normal: vec3f,
}

// Below this a cosine is rounding.
const LEAST_COSINE = 1e-3;

fn reflector_at(at: u32, pixels: u32) -> Reflector {
    return Reflector(surface_normal(at, pixels));
}

fn reflects(reflector: Reflector) -> bool {
    return true;
}

// A place on the disk, lifted onto the hemisphere, has the density cosine / pi (Malley's method).
fn direction_of(reflector: Reflector, place: vec2f) -> vec3f {
    let angle = 6.2831853 * place.y;
    return tangents(reflector.normal) * vec3f(sqrt(place.x) * vec2f(cos(angle), sin(angle)), sqrt(1.0 - place.x));
}

// That density, but for a factor that is the same for all.
fn density_of(reflector: Reflector, direction: vec3f) -> f32 {
    return max(dot(reflector.normal, direction), LEAST_COSINE);
}

// What becomes of light from a direction, over the density.
fn weight_of(reflector: Reflector, direction: vec3f) -> vec3f {
    return vec3f(1.0);
}
