// View rays in rectified coordinates. Passes bind `valid_plane` and `position_planes`, `[3, height, width]`,
// camera space, metres.

#import shared/epipolar_rays
#import shared/lamp_axis
#import shared/medium_span
#import shared/surface_distance
#import shared/view

// View rays that pass a lamp nearer than this, metres, or than this part of its distance, are its light rays.
const LEAST_ASIDE = vec2f(1e-4, 1e-5);

struct SeenRay {
    // Unit vector, world space, and the same in its half-plane: along the axis, and away from it.
    direction: vec3f,
    in_plane: vec2f,
    // From where to where it is in the medium, metres.
    enters: f32,
    leaves: f32,
    // The light rays through both ends; the same where it is one itself.
    gamma: vec2f,
}

fn seen_ray(pixel: vec2u) -> SeenRay {
    let axis = lamp_axis();
    let inside = min(pixel, vec2u(epipolar.width, epipolar.height) - 1u);
    let pixels = epipolar.width * epipolar.height;
    let at = inside.y * epipolar.width + inside.x;
    let reach = surface_distance(at, pixels);
    let direction = from_view(normalize(view_position(vec2f(inside) + 0.5, 1.0, view)), view);
    let span = medium_span(view.eye.xyz, direction, reach);
    let in_plane = in_half_plane(direction, axis);
    let gamma = vec2f(gamma_of(in_plane, span.x, axis), gamma_of(in_plane, span.y, axis));
    let passes = in_plane.y * axis.reach;
    let is_apart = axis.reach < 0.0 || passes > max(LEAST_ASIDE.x, LEAST_ASIDE.y * axis.reach);
    return SeenRay(direction, in_plane, span.x, span.y, select(vec2f(0.0), gamma, is_apart));
}

// Which light rays a view ray crosses, from the first to the last.
fn crossed(ray: SeenRay, bounds: vec2f) -> vec2f {
    return vec2f(number_of(ray.gamma.x, bounds), number_of(ray.gamma.y, bounds));
}

// Whether it is marched, since it crosses few light rays.
fn crosses_few(numbers: vec2f) -> bool {
    return numbers.y - numbers.x < f32(epipolar.least);
}
