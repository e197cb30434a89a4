// How many epipolar lines leave the image before each place of its border, so that neighbours are never more
// than a pixel apart (Baran et al. 2010, section 8; the paper's inverse hyperbolic sine is what these steps
// add up to). One workgroup.

#import shared/epipolar_lines
#import shared/lamp_axis
#import uniforms/epipolar
#import uniforms/frame_view
#import uniforms/light_record

@group(0) @binding(0) var<uniform> epipolar: Epipolar;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
// [border + 3 + 3 parts]: numbers of lines, of which the last is how many there are; the bounds of `gamma`,
// which begin empty; for each part of the lines how many workgroups of 64 light rays a line has, how many
// lines there are with the first and the last, and 1.
@group(0) @binding(3) var<storage, read_write> lines: array<u32>;

const THREADS = 256u;
const LEAVES = 64u;
var<workgroup> totals: array<f32, THREADS>;

// How far apart lines are across their direction that leave at the beginning and at the end of a pixel of the
// border.
fn step_across(place: u32, axis: Axis) -> f32 {
    let begins = border_point(f32(place), axis);
    let ends = border_point(f32(place) + 1.0, axis);
    let along = ends - begins;
    let outwards = vec2f(along.y, -along.x);
    return max(dot(line_direction(0.5 * (begins + ends), axis), outwards), 0.0);
}

@compute @workgroup_size(THREADS)
fn count_lines(@builtin(local_invocation_index) thread: u32) {
    let axis = lamp_axis();
    let places = border();
    let share = (places + THREADS - 1u) / THREADS;
    let first = min(thread * share, places);
    let last = min(first + share, places);
    var total = 0.0;
    for (var place = first; place < last; place++) {
        total += step_across(place, axis);
    }
    totals[thread] = total;
    workgroupBarrier();
    var before = 0.0;
    var all = 0.0;
    for (var i = 0u; i < THREADS; i++) {
        before += select(0.0, totals[i], i < thread);
        all += totals[i];
    }
    // A whole number of lines, so that around an epipole in the image the last is the first.
    let scale = max(ceil(all), 1.0) / max(all, 1e-20);
    for (var place = first; place < last; place++) {
        lines[place] = bitcast<u32>(before * scale);
        before += step_across(place, axis);
    }
    let with_last = u32(max(ceil(all), 1.0)) + 1u;
    let in_part = epipolar.lines - 1u;
    for (var begin = thread * in_part; begin <= places; begin += THREADS * in_part) {
        let counts = places + 3u + 3u * (begin / in_part);
        lines[counts] = epipolar.light_rays / LEAVES;
        // A part that begins with the last line, or behind it, is of no pixel.
        lines[counts + 1u] = select(0u, min(with_last - begin, epipolar.lines), begin + 1u < with_last);
        lines[counts + 2u] = 1u;
    }
    if thread == 0u {
        lines[places] = bitcast<u32>(max(ceil(all), 1.0));
        lines[places + 1u] = 0x7f7fffffu;
        lines[places + 2u] = 0u;
    }
}
