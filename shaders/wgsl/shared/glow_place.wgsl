// A point of a triangle as light falls on it: render/src/path/phosphor.rs.

#import shared/glow_corners
#import shared/lights
#import shared/shadow
#import uniforms/light_record

struct Place {
    position: vec3f,
    geometric: vec3f,
    normal: vec3f,
}

fn vertex_normal(vertex: u32) -> vec3f {
    let first = vertex * POSED + 3u;
    return vec3f(posed[first], posed[first + 1u], posed[first + 2u]);
}

// `weights` are those of the triangle's corners.
fn place_of(vertices: vec3u, weights: vec3f) -> Place {
    let corners = corners_of(vertices);
    let across = cross(corners[1] - corners[0], corners[2] - corners[0]);
    let area = length(across);
    let geometric = select(vec3f(0.0), across / area, area > 0.0);
    let sum = vertex_normal(vertices.x) * weights.x + vertex_normal(vertices.y) * weights.y
        + vertex_normal(vertices.z) * weights.z;
    let length = length(sum);
    let smooth_normal = select(geometric, sum / length, length > 0.0);
    let normal = select(smooth_normal, -smooth_normal, dot(smooth_normal, geometric) < 0.0);
    return Place(corners * weights, geometric, normal);
}

// Irradiance by one lamp on both sides together, W/m². What has no area gets none, though its vertices may
// have normals.
fn received(light: LightRecord, place: Place) -> vec3f {
    let arrived = arrival(light, place.position);
    let facing = dot(place.geometric, arrived.direction);
    let geometric = select(-place.geometric, place.geometric, facing >= 0.0);
    let side = select(select(-1.0, 1.0, facing >= 0.0), 0.0, all(place.geometric == vec3f(0.0)));
    let cosine = dot(place.normal, arrived.direction) * side;
    if cosine <= 0.0 || all(arrived.irradiance == vec3f(0.0)) {
        return vec3f(0.0);
    }
    let shown = lit_share(light, place.position, geometric, arrived.direction);
    return arrived.irradiance * cosine * shown * passed_share(place.position, arrived);
}
