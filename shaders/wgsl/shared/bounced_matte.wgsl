// Surfaces that receive light by its cosine, and look into directions that are spread by it.

#import shared/cosine_direction
#import shared/surface

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

fn direction_of(reflector: Reflector, place: vec2f) -> vec3f {
    return cosine_direction(reflector.normal, place);
}

// That density, but for a factor that is the same for all.
fn density_of(reflector: Reflector, direction: vec3f) -> f32 {
    return max(dot(reflector.normal, direction), LEAST_COSINE);
}

// What becomes of light from a direction, over the density.
fn weight_of(reflector: Reflector, direction: vec3f) -> vec3f {
    return vec3f(1.0);
}
