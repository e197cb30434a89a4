// The area of the surface that each pixel shows, square metres; 0 where none is seen.
// The plain version is render/src/methods/gather/reference.rs.

#import shared/picture
#import shared/translucent
#import uniforms/gather

@group(0) @binding(0) var<uniform> settings: Gather;
@group(0) @binding(5) var<storage, read_write> areas: array<f32>;

// The cosine that seen surfaces have at least: a pixel that shows an edge does not outweigh the image.
const LEAST_COSINE = 0.05;

fn position(index: u32) -> vec3f {
    return translucent_position(index, settings.width * settings.height);
}

fn is_seen(at: vec2i) -> bool {
    if at.x < 0 || at.y < 0 || at.x >= i32(settings.width) || at.y >= i32(settings.height) {
        return false;
    }
    return picture_valid(u32(at.y) * settings.width + u32(at.x));
}

// The surface's way to the neighbour before or after, whichever is nearer in depth; 0 where there is neither.
fn way(pixel: vec2i, here: vec3f, step: vec2i) -> vec3f {
    var nearest = vec3f(0.0);
    for (var side = -1; side <= 1; side += 2) {
        let at = pixel + side * step;
        if !is_seen(at) {
            continue;
        }
        let difference = f32(side) * (position(u32(at.y) * settings.width + u32(at.x)) - here);
        if all(nearest == vec3f(0.0)) || abs(difference.z) < abs(nearest.z) {
            nearest = difference;
        }
    }
    return nearest;
}

@compute @workgroup_size(TILE, TILE)
fn area_of_surface(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.width || id.y >= settings.height {
        return;
    }
    let index = id.y * settings.width + id.x;
    areas[index] = 0.0;
    let pixel = vec2i(id.xy);
    if !is_seen(pixel) {
        return;
    }
    let here = position(index);
    let normal = cross(way(pixel, here, vec2i(1, 0)), way(pixel, here, vec2i(0, 1)));
    var cosine = 1.0;
    if dot(normal, normal) > 0.0 {
        cosine = max(abs(dot(normalize(normal), normalize(here))), LEAST_COSINE);
    }
    // The pixel's solid angle, cos^3 / f^2, at the distance, over the cosine of the surface.
    let size = -here.z / settings.focal_length;
    areas[index] = size * size * -here.z / (length(here) * cosine);
}
