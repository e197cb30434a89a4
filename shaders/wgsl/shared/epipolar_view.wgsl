// View rays in rectified coordinates. Passes bind `valid_plane` and `position_planes`, `[3, height, width]`, camera space, metres.

// Lamps that are nearer to the eye, metres, are at the eye.
const AT_THE_EYE = 1e-4;

struct SeenRay {
    // Unit vector, world space, and the same in its half-plane: along the axis, and away from it.
    direction: vec3f,
    in_plane: vec2f,
    // Where it is in the medium and anything is seen of it, metres.
    enters: f32,
    leaves: f32,
    // The light rays through both ends.
    gamma: vec2f,
}

fn seen_ray(pixel: vec2u) -> SeenRay {
    let axis = lamp_axis();
    let inside = min(pixel, vec2u(epipolar.width, epipolar.height) - 1u);
    let pixels = epipolar.width * epipolar.height;
    let at = inside.y * epipolar.width + inside.x;
    let position = vec3f(position_planes[at], position_planes[at + pixels], position_planes[at + 2u * pixels]);
    let reach = select(1e30, length(position), valid_plane[at] > 0.5);
    let direction = from_view(normalize(view_position(vec2f(inside) + 0.5, 1.0, view)), view);
    let span = medium_span(view.eye.xyz, direction, reach);
    let extinction = medium.extinction.rgb;
    let deep = FARTHEST_DEPTH / max(min(extinction.r, min(extinction.g, extinction.b)), 1e-12);
    let leaves = min(span.y, span.x + deep);
    let in_plane = in_half_plane(direction, axis);
    let gamma = vec2f(gamma_of(in_plane, span.x, axis), gamma_of(in_plane, leaves, axis));
    // At the eye a lamp's rays are the view rays.
    let is_apart = axis.reach < 0.0 || axis.reach > AT_THE_EYE;
    return SeenRay(direction, in_plane, span.x, leaves, select(vec2f(0.0), gamma, is_apart));
}

// Which light rays a view ray crosses, from the first to the last.
fn crossed(ray: SeenRay, bounds: vec2f) -> vec2f {
    return vec2f(number_of(ray.gamma.x, bounds), number_of(ray.gamma.y, bounds));
}

// Whether it is marched, since it crosses few light rays.
fn crosses_few(numbers: vec2f) -> bool {
    return numbers.y - numbers.x < f32(epipolar.least);
}
