// Fast approximate anti-aliasing, one invocation a pixel (Lottes 2011, version 3.11, quality): where luma has
// an edge, the pixel is blended with its neighbour across the edge by how much of it lies beyond. The plain
// version is render/src/methods/fxaa/reference.rs; both do the same, line by line.

#import shared/bounded
#import shared/picture
#import uniforms/fxaa

@group(0) @binding(0) var<uniform> fxaa: Fxaa;
@group(0) @binding(3) var<storage, read> luma: array<f32>;
// Lengths of the search's steps, pixels.
@group(0) @binding(4) var<uniform> lengths: array<vec4f, 3>;
@group(0) @binding(5) var<storage, read_write> smoothed: array<f32>;

// The pixel with this offset from another, or the nearest inside the image.
fn neighbour(pixel: vec2i, offset: vec2i) -> u32 {
    let at = clamp(pixel + offset, vec2i(0), vec2i(i32(fxaa.width), i32(fxaa.height)) - 1);
    return u32(at.y) * fxaa.width + u32(at.x);
}

fn luma_at(pixel: vec2i, offset: vec2i) -> f32 {
    return luma[neighbour(pixel, offset)];
}

// Luma halfway between a pixel and its neighbour across the edge, `distance` pixels along the edge from it.
fn luma_between(pixel: vec2i, across: vec2i, along: vec2i, distance: f32) -> f32 {
    let whole = floor(distance);
    let part = distance - whole;
    let near = pixel + i32(whole) * along;
    let first = luma_at(near, vec2i(0)) + luma_at(near, across);
    let second = luma_at(near, along) + luma_at(near, along + across);
    return 0.5 * (first * (1.0 - part) + second * part);
}

// Of two numbers that are alike but for rounding, every processor takes the first for the greater: between
// flat colours ties are common.
fn is_first_more(first: f32, second: f32) -> bool {
    return first >= 0.9999 * second;
}

// How far an edge goes on in one direction, and by how much luma differs there from that of the edge.
fn edge_end(pixel: vec2i, across: vec2i, along: vec2i, middle: f32, threshold: f32) -> vec2f {
    var distance = 0.0;
    var difference = 0.0;
    let steps = bounded(fxaa.steps, vec2u(pixel));
    for (var step = 0u; step < steps; step++) {
        distance += lengths[step / 4u][step % 4u];
        difference = luma_between(pixel, across, along, distance) - middle;
        if is_first_more(abs(difference), threshold) {
            break;
        }
    }
    return vec2f(distance, difference);
}

@compute @workgroup_size(TILE, TILE)
fn smooth_edges(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= fxaa.width || id.y >= fxaa.height {
        return;
    }
    let pixel = vec2i(id.xy);
    let pixels = fxaa.width * fxaa.height;
    let index = id.y * fxaa.width + id.x;
    let light = picture_light(index, pixels);
    smoothed[index] = light.x;
    smoothed[index + pixels] = light.y;
    smoothed[index + 2u * pixels] = light.z;

    let m = luma_at(pixel, vec2i(0, 0));
    let n = luma_at(pixel, vec2i(0, -1));
    let s = luma_at(pixel, vec2i(0, 1));
    let w = luma_at(pixel, vec2i(-1, 0));
    let e = luma_at(pixel, vec2i(1, 0));
    let brightest = max(m, max(max(n, s), max(w, e)));
    let range = brightest - min(m, min(min(n, s), min(w, e)));
    if range <= max(fxaa.least_contrast, fxaa.contrast * brightest) {
        return;
    }
    let nw = luma_at(pixel, vec2i(-1, -1));
    let ne = luma_at(pixel, vec2i(1, -1));
    let sw = luma_at(pixel, vec2i(-1, 1));
    let se = luma_at(pixel, vec2i(1, 1));

    // How much the pixel stands out from the mean of its neighbours.
    let mean = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
    let outstanding = smoothstep(0.0, 1.0, abs(mean - m) / range);
    let subpixel = fxaa.subpixel * outstanding * outstanding;

    // Which way the edge runs, and on which side of the pixel it is.
    let up_down = abs(nw + sw - 2.0 * w) + 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e);
    let left_right = abs(nw + ne - 2.0 * n) + 2.0 * abs(w + e - 2.0 * m) + abs(sw + se - 2.0 * s);
    let horizontal = is_first_more(up_down, left_right);
    let before = select(w, n, horizontal);
    let after = select(e, s, horizontal);
    let side = select(1, -1, is_first_more(abs(before - m), abs(after - m)));
    let across = side * select(vec2i(1, 0), vec2i(0, 1), horizontal);
    let along = select(vec2i(0, 1), vec2i(1, 0), horizontal);
    let beyond = select(after, before, side < 0);
    let middle = 0.5 * (m + beyond);
    let threshold = 0.25 * abs(beyond - m);

    // The nearer end says how far the edge has come towards the pixel.
    let backward = edge_end(pixel, across, -along, middle, threshold);
    let forward = edge_end(pixel, across, along, middle, threshold);
    let nearer = select(forward, backward, backward.x < forward.x);
    let crossing = (nearer.y < 0.0) != (m < middle);
    let slope = select(0.0, 0.5 - nearer.x / (backward.x + forward.x), crossing);
    let blend = max(slope, subpixel);

    let mixed = light + (picture_light(neighbour(pixel, across), pixels) - light) * blend;
    smoothed[index] = mixed.x;
    smoothed[index + pixels] = mixed.y;
    smoothed[index + 2u * pixels] = mixed.z;
}
