// Where a finer grid lies in a coarser one: around the camera, a cube of half the longest extent, or what of
// it lies within the coarser one, which begins between cells of it; cells of half the edge:
// render/src/lpv/grid.rs.

#import uniforms/frame_view
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read_write> nested: LightGrid;

const FEWEST_COVERED = 7.0;
const NOWHERE = 1e9;

@compute @workgroup_size(1)
fn nest() {
    let longest = max(grid.size.x, max(grid.size.y, grid.size.z));
    let covers = min(grid.size.xyz, vec3f(max(floor((longest + 1.0) / 2.0), FEWEST_COVERED)));
    let middle = (view.eye.xyz - grid.low.xyz) / grid.low.w;
    let begin = clamp(floor(middle - 0.5 * covers + 0.5), vec3f(0.0), grid.size.xyz - covers);
    let size = 2.0 * covers;
    nested.low = vec4f(grid.low.xyz + grid.low.w * begin, 0.5 * grid.low.w);
    nested.size = vec4f(size, size.x * size.y * size.z);
    let has_low = (begin > vec3f(0.0)) | (grid.begins.xyz == vec3f(0.0));
    let has_high = (begin + covers < grid.size.xyz) | (grid.ends.xyz == grid.size.xyz);
    nested.begins = vec4f(select(vec3f(-NOWHERE), vec3f(0.0), has_low), 0.0);
    nested.ends = vec4f(select(vec3f(NOWHERE), size, has_high), 0.0);
}
