// Where the light rays of slices end: the rectified shadow map (Baran et al. 2010, section 3), as values of
// `beta`. Light rays that nothing stops end at 2.

#import shared/epipolar_lines
#import shared/epipolar_part
#import shared/epipolar_rays
#import shared/lamp_axis
#import shared/shadow
#import shared/view
#import uniforms/epipolar
#import uniforms/frame_view
#import uniforms/light_record

@group(0) @binding(0) var<uniform> epipolar: Epipolar;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(4) var<storage, read> lines: array<u32>;
// [lines of the part, light rays]
@group(0) @binding(5) var<storage, read_write> ends: array<f32>;
@group(0) @binding(6) var maps: texture_depth_2d_array;
// Not asked: of light rays depths themselves are wanted.
@group(0) @binding(7) var map_sampler: sampler_comparison;

const NEVER = 2.0;

// The place of the border where a line leaves, by bisection.
fn leaves_at(line: u32) -> f32 {
    // Of the last one that place counts which comes before those where no line leaves, whatever rounding made
    // of their numbers.
    let number = min(f32(line), bitcast<f32>(lines[border()]) - 0.05);
    var low = 0u;
    var high = border();
    while low + 1u < high {
        let middle = (low + high) / 2u;
        if bitcast<f32>(lines[middle]) <= number {
            low = middle;
        } else {
            high = middle;
        }
    }
    let before = bitcast<f32>(lines[low]);
    let step = bitcast<f32>(lines[low + 1u]) - before;
    return f32(low) + clamp((number - before) / max(step, 1e-20), 0.0, 1.0);
}

// Depth of the first surface on the ray through a point, along the axis of the map that shows it, and that of
// the point; no surface where the second is negative.
fn blocker(light: LightRecord, point: vec3f) -> vec2f {
    if light.power.w < 0.0 {
        return vec2f(0.0, -1.0);
    }
    let map = map_of(light, point);
    let map_view = map_views[map];
    let offset = point - map_view.eye.xyz;
    let clip = clip_position(offset, map_view);
    let at = clip.xy / clip.w;
    let size = f32(map_view.width);
    let texel = vec2f(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y) * size;
    if clip.w <= 0.0 || any(texel < vec2f(0.0)) || any(texel >= vec2f(size)) {
        return vec2f(0.0, -1.0);
    }
    let stored = textureLoad(maps, vec2u(texel), map, 0);
    if stored <= 0.0 {
        return vec2f(0.0, -1.0);
    }
    return vec2f(-to_view(offset, map_view).z, depth_of(stored, map_view));
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    let number = id.x;
    let line = first_line() + id.y;
    if number >= epipolar.light_rays {
        return;
    }
    let axis = lamp_axis();
    let pixel = border_point(leaves_at(line), axis);
    let direction = from_view(normalize(view_position(pixel, 1.0, view)), view);
    let aside = direction - axis.direction * dot(direction, axis.direction);
    let outwards = aside / max(length(aside), 1e-20);
    let gamma = gamma_at(f32(number) + 0.5, gamma_bounds());
    var end = NEVER;
    if axis.reach < 0.0 {
        let found = blocker(lights[of_lamp.number], view.eye.xyz + outwards * gamma);
        if found.y >= 0.0 {
            end = beta_of(vec2f(found.x - found.y, gamma));
        }
    } else {
        let along = outwards * sin(gamma) - axis.direction * cos(gamma);
        let found = blocker(lights[of_lamp.number], lights[of_lamp.number].place.xyz + along);
        if found.y >= 0.0 {
            let distance = found.y / max(found.x, 1e-20);
            end = beta_of(vec2f(axis.reach - distance * cos(gamma), distance * sin(gamma)));
        }
    }
    ends[id.y * epipolar.light_rays + number] = end;
}
