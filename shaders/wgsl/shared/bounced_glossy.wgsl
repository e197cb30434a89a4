// Surfaces that reflect light to the eye by a lobe, and look into directions that are spread by it.

#import shared/lobe
#import shared/surface
#import shared/tangents

alias Reflector = Lobe;

// Less is rounding.
const LEAST_DENSITY = 1e-6;

fn reflector_at(at: u32, pixels: u32) -> Reflector {
    return lobe_at(at, surface_position(at, pixels), surface_normal(at, pixels));
}

fn reflects(reflector: Reflector) -> bool {
    return shines(reflector);
}

// The eye's direction, mirrored by a facet that it sees (Heitz 2018; drawn as Dupuy and Benyoub 2023 do, from
// a spherical cap). May be below the surface.
fn direction_of(reflector: Reflector, place: vec2f) -> vec3f {
    let to_world = tangents(reflector.normal);
    let viewer = transpose(to_world) * reflector.viewer;
    let stretched = normalize(vec3f(reflector.alpha * viewer.xy, viewer.z));
    let height = (1.0 - place.x) * (1.0 + stretched.z) - stretched.z;
    let radius = sqrt(max(1.0 - height * height, 0.0));
    let angle = 6.2831853 * place.y;
    let cap = vec3f(radius * vec2f(cos(angle), sin(angle)), height) + stretched;
    let bent = vec3f(reflector.alpha * cap.xy, cap.z);
    let facet = select(vec3f(0.0, 0.0, 1.0), normalize(bent), dot(bent, bent) > 0.0);
    return to_world * (facet * (2.0 * dot(viewer, facet)) - viewer);
}

fn density_of(reflector: Reflector, direction: vec3f) -> f32 {
    return max(lobe_density(reflector, direction), LEAST_DENSITY);
}

fn weight_of(reflector: Reflector, direction: vec3f) -> vec3f {
    return fresnel(reflector, facet_between(reflector, direction)) * lobe_visibility(reflector, direction);
}
