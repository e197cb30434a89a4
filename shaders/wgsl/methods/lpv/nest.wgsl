// Where a finer grid lies in a coarser one: around the camera, a box of half the extent that begins between
// cells of the coarser one and lies within it; as many cells of half the edge: render/src/lpv/grid.rs.

#import uniforms/frame_view
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read_write> nested: LightGrid;

@compute @workgroup_size(1)
fn nest() {
    let covers = floor((grid.size.xyz + 1.0) / 2.0);
    let middle = (view.eye.xyz - grid.low.xyz) / grid.low.w;
    let begin = clamp(floor(middle - 0.5 * covers + 0.5), vec3f(0.0), grid.size.xyz - covers);
    let size = 2.0 * covers;
    nested.low = vec4f(grid.low.xyz + grid.low.w * begin, 0.5 * grid.low.w);
    nested.size = vec4f(size, size.x * size.y * size.z);
}
