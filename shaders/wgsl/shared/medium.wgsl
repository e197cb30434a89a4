// What fills the space between surfaces: render/src/scene/medium.rs. Passes bind `medium` and `densities`.

// What `MEDIUM` is: a constant, since lavapipe compiles shaders anew where uniforms alone decide on a branch.
const EVERYWHERE = 0u;
const GRID = 2u;
// Beyond so many mean free paths nothing is seen of a medium without an end.
const FARTHEST_DEPTH = 16.0;

// The part of a ray, world space, that lies in the medium: from which distance to which; where it does not, the second is no
// larger.
fn medium_span(origin: vec3f, direction: vec3f, reach: f32) -> vec2f {
    if MEDIUM == EVERYWHERE {
        let extinction = medium.extinction.rgb;
        let least = min(extinction.r, min(extinction.g, extinction.b));
        return vec2f(0.0, min(reach, FARTHEST_DEPTH / max(least, 1e-12)));
    }
    // The slab method (Kay and Kajiya 1986); along a face the quotient is infinite, not 0 / 0.
    let along = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let a = (medium.low.xyz - origin) / along;
    let b = (medium.high.xyz - origin) / along;
    let enters = max(min(a, b), vec3f(0.0));
    let leaves = min(max(a, b), vec3f(reach));
    return vec2f(max(enters.x, max(enters.y, enters.z)), min(leaves.x, min(leaves.y, leaves.z)));
}

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

// Density times length along a piece of a ray, metres: exact where density is the same everywhere, else by so many points.
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
