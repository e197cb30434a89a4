// Light rays of a lamp, the same in all slices: denser towards the line from the eye to the lamp, since view
// rays near it cross none that are farther away. Passes bind `epipolar`. The plain version is
// render/src/methods/epipolar/{geometry,spacing}.rs.

#import shared/growing
#import shared/lamp_axis

// The direction of a view ray in its half-plane: along the axis, and away from it.
fn in_half_plane(direction: vec3f, axis: Axis) -> vec2f {
    let along = dot(direction, axis.direction);
    return vec2f(along, length(direction - axis.direction * along));
}

// What stands for the angle between the direction to the light and that to a point: from 0 to 2.
fn beta_of(point: vec2f) -> f32 {
    return 1.0 - point.x / (abs(point.x) + point.y);
}

// The light ray through the point that is so far along a view ray: its distance from the eye, or its angle at
// the lamp.
fn gamma_of(ray: vec2f, distance: f32, axis: Axis) -> f32 {
    if axis.reach < 0.0 {
        return distance * ray.y;
    }
    return atan2(distance * ray.y, axis.reach - distance * ray.x);
}

// `gamma` of a fractional light ray.
fn gamma_at(number: f32, bounds: vec2f) -> f32 {
    return mix(bounds.x, bounds.y, growing(number / f32(epipolar.light_rays)));
}

// How much `gamma` grows from one light ray to the next there.
fn gamma_growth(number: f32, bounds: vec2f) -> f32 {
    let rays = f32(epipolar.light_rays);
    return (bounds.y - bounds.x) / rays * growth_at(number / rays);
}

// Which fractional light ray is at a value of `gamma`.
fn number_of(gamma: f32, bounds: vec2f) -> f32 {
    let passed = clamp((gamma - bounds.x) / max(bounds.y - bounds.x, 1e-30), 0.0, 1.0);
    return f32(epipolar.light_rays) * share_of_parts(passed);
}
