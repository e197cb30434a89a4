// The form factor from a point with a normal to that part of a facet which is above the point's tangent plane
// and within reach: the integral along the outline of the part (Lambert 1760; Baum, Rushmeier and Winget
// 1989). The outline has pieces of the edges, which look like arcs of great circles, and arcs of the circle
// in which the facet's plane cuts the sphere of the reach. The plain version is
// render/src/methods/aov/polygon.rs.

// The circle in which a plane cuts the sphere around the point, which is the origin.
struct Circle {
    centre: vec3f,
    // Unit normal of the plane, away from the point; outlines go round it counter-clockwise.
    axis: vec3f,
    radius: f32,
    // Of the sphere, squared.
    reach_squared: f32,
    // The point's.
    normal: vec3f,
}

struct Outline {
    // Along it so far, times two pi.
    sum: f32,
    // Whether an edge is in the circle.
    touched: bool,
    // Whether the circle's centre is to the left of all edges.
    around: bool,
}

// Along a straight piece.
fn straight(begin: vec3f, end: vec3f, normal: vec3f) -> f32 {
    // As exact for a short edge as for a long one, which cross(begin, end) is not.
    let across = cross(begin, end - begin);
    let size = length(across);
    let along = dot(begin, end);
    if size < 1e-30 {
        return 0.0;
    }
    var angle_over_size = atan2(size, along) / size;
    // Where all angles are small they cancel but for a remainder, which atan2 alone is not exact enough for:
    // a series.
    if size < 0.3 * along {
        let t = size * size / (along * along);
        angle_over_size = (1.0 - t * (1.0 / 3.0 - t * (0.2 - t * (1.0 / 7.0 - t / 9.0)))) / along;
    }
    return angle_over_size * dot(normal, across);
}

// Along the circle, from the direction of one point seen from its centre to that of another.
fn round(begin: vec3f, end: vec3f, circle: Circle) -> f32 {
    let first = begin - circle.centre;
    let last = end - circle.centre;
    let angle = atan2(dot(circle.axis, cross(first, end - begin)), dot(first, last));
    let chord = circle.radius * (normalize(last) - normalize(first));
    let swept = cross(circle.centre, chord) + circle.radius * circle.radius * angle * circle.axis;
    return dot(circle.normal, swept) / circle.reach_squared;
}

// An outline with an edge more.
fn with_edge(outline: Outline, begin: vec3f, end: vec3f, circle: Circle) -> Outline {
    var it = outline;
    let way = end - begin;
    let a = dot(way, way);
    if a == 0.0 {
        return it;
    }
    it.around = it.around && dot(circle.axis, cross(begin - circle.centre, way)) >= 0.0;
    let b = dot(begin, way);
    let inside = b * b - a * (dot(begin, begin) - circle.reach_squared);
    let half = sqrt(max(inside, 0.0));
    let first = max((-b - half) / a, 0.0);
    let last = min((half - b) / a, 1.0);
    if inside <= 0.0 || first >= last {
        it.sum += round(begin, end, circle);
        return it;
    }
    it.touched = true;
    let enters = begin + first * way;
    let leaves = begin + last * way;
    it.sum += straight(enters, leaves, circle.normal);
    if first > 0.0 {
        it.sum += round(begin, enters, circle);
    }
    if last < 1.0 {
        it.sum += round(leaves, end, circle);
    }
    return it;
}

// Corners relative to the point. Of closed surfaces only fronts count.
fn facet_form_factor(at: mat3x3f, is_open: bool, normal: vec3f, reach: f32) -> f32 {
    var corners = at;
    var outwards = cross(at[1] - at[0], at[2] - at[0]);
    if is_open && dot(at[0], outwards) > 0.0 {
        corners = mat3x3f(at[0], at[2], at[1]);
        outwards = -outwards;
    }
    let distance = -dot(corners[0], outwards) / length(outwards);
    let heights = normal * corners;
    // Not what is no number either.
    if !(distance > 0.0 && distance < reach && any(heights > vec3f(0.0))) {
        return 0.0;
    }
    let axis = -normalize(outwards);
    let radius = sqrt(reach * reach - distance * distance);
    let circle = Circle(distance * axis, axis, radius, reach * reach, normal);
    var outline = Outline(0.0, false, true);
    var leaves = vec3f(0.0);
    var enters = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        // Seen from the point the corners go round the other way.
        let begin = corners[2u - i];
        let end = corners[(4u - i) % 3u];
        let begin_height = heights[2u - i];
        let end_height = heights[(4u - i) % 3u];
        if begin_height <= 0.0 && end_height <= 0.0 {
            continue;
        }
        let horizon = mix(begin, end, begin_height / (begin_height - end_height));
        let is_below = vec2<bool>(begin_height <= 0.0, end_height <= 0.0);
        enters = select(enters, horizon, is_below.x);
        leaves = select(leaves, horizon, is_below.y);
        outline = with_edge(outline, select(begin, horizon, is_below.x), select(end, horizon, is_below.y), circle);
    }
    if any(heights <= vec3f(0.0)) {
        outline = with_edge(outline, leaves, enters, circle);
    }
    if outline.touched {
        return max(outline.sum / TAU, 0.0);
    }
    let whole = max(dot(normal, axis), 0.0) * radius * radius / (reach * reach);
    return select(0.0, whole, outline.around);
}
