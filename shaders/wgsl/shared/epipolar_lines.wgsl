// Lines through the epipole, and where they leave the image. Places on its border are counted clockwise,
// pixels, from where the line through its middle comes in: if not all places are such where lines leave,
// those that are follow each other. Passes bind `epipolar` and `lines`: how many lines leave before each
// place of the border, then the least and the largest `gamma` that is seen.

#import shared/lamp_axis
#import shared/view

fn border() -> u32 {
    return 2u * (epipolar.width + epipolar.height);
}

// The point of the border that is so far from the top left corner.
fn corner_point(place: f32) -> vec2f {
    let width = f32(epipolar.width);
    let height = f32(epipolar.height);
    if place < width {
        return vec2f(place, 0.0);
    }
    if place < width + height {
        return vec2f(width, place - width);
    }
    if place < 2.0 * width + height {
        return vec2f(2.0 * width + height - place, height);
    }
    return vec2f(0.0, max(2.0 * (width + height) - place, 0.0));
}

// The direction of the line through a point of the image: away from the light, or from its opposite if it is
// behind the eye. The epipole is homogeneous, so that it may be infinitely far away.
fn line_direction(point: vec2f, axis: Axis) -> vec2f {
    let at = to_view(axis.direction, view);
    let half = 0.5 * vec2f(f32(epipolar.width), f32(epipolar.height));
    let forward = -at.z;
    let epipole = half * forward + half * vec2f(view.scale_x * at.x, -view.scale_y * at.y);
    let away = (point * forward - epipole) * select(-1.0, 1.0, forward >= 0.0);
    return select(vec2f(1.0, 0.0), normalize(away), dot(away, away) > 0.0);
}

// Where a ray in the image meets its border, from the top left corner.
fn place_along(point: vec2f, along: vec2f) -> f32 {
    let size = vec2f(f32(epipolar.width), f32(epipolar.height));
    let steps = (select(vec2f(0.0), size, along > vec2f(0.0)) - point) / select(along, vec2f(1e-20), abs(along) < vec2f(1e-20));
    let leaves = point + along * min(abs(steps.x), abs(steps.y));
    if abs(steps.x) < abs(steps.y) {
        return select(2.0 * (size.x + size.y) - leaves.y, size.x + leaves.y, along.x > 0.0);
    }
    return select(leaves.x, 2.0 * size.x + size.y - leaves.x, along.y > 0.0);
}

// Where places are counted from.
fn first_place(axis: Axis) -> f32 {
    let middle = 0.5 * vec2f(f32(epipolar.width), f32(epipolar.height));
    return floor(place_along(middle, -line_direction(middle, axis)));
}

fn border_point(place: f32, axis: Axis) -> vec2f {
    let around = f32(border());
    let from_corner = place + first_place(axis);
    return corner_point(from_corner - select(0.0, around, from_corner >= around));
}

// The fractional line through a point of the image.
fn line_through(point: vec2f, axis: Axis) -> f32 {
    let from_first = place_along(point, line_direction(point, axis)) - first_place(axis);
    let place = from_first + select(0.0, f32(border()), from_first < 0.0);
    let last = border() - 1u;
    let before = min(u32(max(place, 0.0)), last);
    let first = bitcast<f32>(lines[before]);
    return mix(first, bitcast<f32>(lines[before + 1u]), clamp(place - f32(before), 0.0, 1.0));
}

// Between which values of `gamma` light rays are.
fn gamma_bounds() -> vec2f {
    let place = 2u * (epipolar.width + epipolar.height) + 1u;
    return vec2f(bitcast<f32>(lines[place]), bitcast<f32>(lines[place + 1u]));
}
