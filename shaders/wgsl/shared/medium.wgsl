// How dense it is there: render/src/scene/medium.rs. Passes bind `medium` and `densities`.

#import shared/medium_span
#constant MEDIUM = 2

fn density_of_cell(cell: vec3i) -> f32 {
    return textureLoad(densities, clamp(cell, vec3i(0), vec3i(medium.cells.xyz) - 1), 0).r;
}

// Density at a point of the medium's box, trilinear between the middles of cells.
fn density_inside(point: vec3f) -> f32 {
    if MEDIUM != GRID {
        return 1.0;
    }
    let at = (point - medium.low.xyz) / (medium.high.xyz - medium.low.xyz) * medium.cells.xyz - 0.5;
    let within = clamp(at, vec3f(0.0), medium.cells.xyz - 1.0);
    let low = vec3i(within);
    let part = within - vec3f(low);
    let x00 = mix(density_of_cell(low), density_of_cell(low + vec3i(1, 0, 0)), part.x);
    let x10 = mix(density_of_cell(low + vec3i(0, 1, 0)), density_of_cell(low + vec3i(1, 1, 0)), part.x);
    let x01 = mix(density_of_cell(low + vec3i(0, 0, 1)), density_of_cell(low + vec3i(1, 0, 1)), part.x);
    let x11 = mix(density_of_cell(low + vec3i(0, 1, 1)), density_of_cell(low + vec3i(1, 1, 1)), part.x);
    return mix(mix(x00, x10, part.y), mix(x01, x11, part.y), part.z);
}

// Density times length along a piece of a ray, metres: exact where density is the same everywhere, else by so
// many points.
fn passed_density(origin: vec3f, direction: vec3f, reach: f32, points: u32) -> f32 {
    let span = medium_span(origin, direction, reach);
    let length = max(span.y - span.x, 0.0);
    if MEDIUM != GRID {
        return length;
    }
    let step = length / f32(points);
    var sum = 0.0;
    for (var i = 0u; i < points; i++) {
        sum += density_inside(origin + direction * (span.x + (f32(i) + 0.5) * step));
    }
    return sum * step;
}
