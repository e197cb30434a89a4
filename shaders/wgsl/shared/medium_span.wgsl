// Where what fills the space between surfaces is: render/src/scene/medium.rs. Passes bind `medium`.

#constant MEDIUM = 2

// What `MEDIUM` is: a constant, since lavapipe compiles shaders anew where uniforms alone decide on a branch.
const EVERYWHERE = 0u;
const GRID = 2u;
// Beyond so many mean free paths nothing is seen of a medium that is the same throughout.
const FARTHEST_DEPTH = 16.0;

// The part of a ray, world space, that lies in the medium and of which anything is seen: from which distance
// to which; where there is none, the second is no larger.
fn medium_span(origin: vec3f, direction: vec3f, reach: f32) -> vec2f {
    let extinction = medium.extinction.rgb;
    let farthest = FARTHEST_DEPTH / max(min(extinction.r, min(extinction.g, extinction.b)), 1e-12);
    if MEDIUM == EVERYWHERE {
        return vec2f(0.0, min(reach, farthest));
    }
    // The slab method (Kay and Kajiya 1986); along a face the quotient is infinite, not 0 / 0.
    let along = select(direction, vec3f(1e-12), abs(direction) < vec3f(1e-12));
    let a = (medium.low.xyz - origin) / along;
    let b = (medium.high.xyz - origin) / along;
    let enters = max(min(a, b), vec3f(0.0));
    let leaves = min(max(a, b), vec3f(reach));
    let begins = max(enters.x, max(enters.y, enters.z));
    let ends = min(leaves.x, min(leaves.y, leaves.z));
    if MEDIUM == GRID {
        return vec2f(begins, ends);
    }
    return vec2f(begins, min(ends, begins + farthest));
}
