// What of a point's light is a grid's: nothing of a finer one's beside its border, all of it farther in; the
// rest is of the coarser one: render/src/lpv/grid.rs. NESTED says whether the grid is in a coarser one, FINER
// whether one is in it. Passes bind `grid` and `finer`.

#import uniforms/light_grid
#constant FINER = 1
#constant NESTED = 1

const FADES = vec2f(2.0, 4.0);

fn share_in(nested: LightGrid, point: vec3f) -> f32 {
    let at = (point - nested.low.xyz) / nested.low.w;
    let depths = min(at, nested.size.xyz - at);
    let depth = min(depths.x, min(depths.y, depths.z));
    return clamp((depth - FADES.x) / (FADES.y - FADES.x), 0.0, 1.0);
}

fn share_here(point: vec3f) -> f32 {
    var share = 1.0;
    if NESTED == 1u {
        share = share_in(grid, point);
    }
    if FINER == 1u {
        share *= 1.0 - share_in(finer, point);
    }
    return share;
}
