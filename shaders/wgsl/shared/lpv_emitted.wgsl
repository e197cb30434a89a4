// What the medium in a cell of a density scatters of light that the scene sends by itself, watts; a grid's
// medium scatters alike in all directions. Passes bind `grid` and `medium`.

#import shared/lpv_grid
#import shared/lpv_medium

// [3, cells]: flux and energy times lengths of ways, watts times cells
@group(0) @binding(9) var<storage, read> emitted: array<vec4f>;

fn scattered_of_emitted(cell: u32, density: f32) -> vec3f {
    let cells = cell_count();
    let arrived = vec3f(emitted[cell].w, emitted[cells + cell].w, emitted[2u * cells + cell].w);
    return arrived * (reduced_extinction() * reduced_albedo() * (density * grid.low.w));
}
