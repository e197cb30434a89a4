// The fog in front of each pixel: sums of columns of froxels, between where columns are lit and the ends of
// slices (Wronski 2014, pass 4). The plain version is render/src/methods/froxel/reference.rs.

#import shared/froxel_index
#import shared/froxels
#import shared/surface_distance
#import shared/view
#import uniforms/frame_view
#import uniforms/froxels
#import uniforms/medium_record

@group(0) @binding(0) var<uniform> froxels: Froxels;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<uniform> medium: MediumRecord;
@group(0) @binding(3) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(4) var<storage, read> position_planes: array<f32>;
@group(0) @binding(5) var<storage, read> sums: array<vec4f>;
// [3, height, width]
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

fn sum_before(column: vec2u, slice: u32) -> vec3f {
    if slice == 0u {
        return vec3f(0.0);
    }
    return sums[froxel_index(vec3u(column, slice - 1u))].rgb;
}

@compute @workgroup_size(TILE, TILE)
fn apply(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= froxels.width || id.y >= froxels.height {
        return;
    }
    let pixels = froxels.width * froxels.height;
    let at = id.y * froxels.width + id.x;
    let reach = surface_distance(at, pixels);
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    let slice = slice_at(reach, froxel_range(direction));
    let first = min(u32(slice), froxels.slices - 1u);
    let on = slice - f32(first);
    let last = vec2u(froxels.columns, froxels.rows) - 1u;
    let column = clamp((vec2f(id.xy) + 0.5) / f32(froxels.tile) - froxel_shift().xy, vec2f(0.0), vec2f(last));
    let low = vec2u(column);
    let part = column - vec2f(low);
    var sum = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2u(i & 1u, i >> 1u);
        let weights = select(1.0 - part, part, corner == vec2u(1u));
        let beside = min(low + corner, last);
        sum += weights.x * weights.y * mix(sum_before(beside, first), sum_before(beside, first + 1u), on);
    }
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] = sum[c];
    }
}
