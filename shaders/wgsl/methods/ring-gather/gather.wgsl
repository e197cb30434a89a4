// What is seen through the lens at a pixel, gathered on rings: what is behind or beside the pixel's own
// surface, and what lies in front and spreads over it. One invocation a gathered pixel. The plain version is
// render/src/methods/ring_gather/reference.rs; both do the same, line by line.

#import uniforms/ring_gather

@group(0) @binding(0) var<uniform> gather: RingGather;
@group(0) @binding(1) var<storage, read> low: array<vec4f>;
@group(0) @binding(2) var<storage, read> largest_around: array<f32>;
// Mean radiance of what is not in front.
@group(0) @binding(3) var<storage, read_write> behind: array<vec4f>;
// Radiance of what is in front times how much of the pixel it covers, and that.
@group(0) @binding(4) var<storage, read_write> before: array<vec4f>;

const PI = 3.14159265;

// Whether a circle is in front of another, given signed radii.
fn in_front(radius: f32, other: f32) -> f32 {
    return saturate((other - radius) / gather.softness);
}

// Rings at multiples of the spacing, 8 samples on the first, 16 on the second, ...: each sample, and the
// pixel itself, stands for as much area as a circle whose diameter is the spacing.
fn ring_count(radius: f32) -> u32 {
    return min(gather.rings, u32(ceil(radius)));
}

fn sample_offset(ring: u32, step: u32, spacing: f32) -> vec2f {
    let angle = f32(step) * (2.0 * PI / f32(8u * ring));
    return floor(f32(ring) * spacing * vec2f(cos(angle), sin(angle)) + 0.5);
}

fn is_inside(at: vec2i) -> bool {
    return at.x >= 0 && at.y >= 0 && at.x < i32(gather.low_width) && at.y < i32(gather.low_height);
}

// Mean of what the pixel's own circle covers and is not in front: through the lens the pixel's surface is
// seen, or past its edge what is behind.
fn gather_behind(pixel: vec2i, centre: vec4f) -> vec3f {
    let radius = abs(centre.w) / f32(gather.scale);
    if radius < 0.5 {
        return centre.xyz;
    }
    let rings = ring_count(radius);
    let spacing = radius / (f32(rings) + 0.5);
    var light = centre.xyz;
    var weights = 1.0;
    for (var ring = 1u; ring <= rings; ring++) {
        for (var step = 0u; step < 8u * ring; step++) {
            let at = pixel + vec2i(sample_offset(ring, step, spacing));
            if !is_inside(at) {
                continue;
            }
            let sample = low[u32(at.y) * gather.low_width + u32(at.x)];
            let weight = 1.0 - in_front(sample.w, centre.w);
            light += weight * sample.xyz;
            weights += weight;
        }
    }
    return light / weights;
}

// Every sample in front whose own circle holds the pixel gives its light, thinned out over that circle.
fn gather_before(pixel: vec2i, centre: vec4f, radius: f32) -> vec4f {
    if radius < 0.5 {
        return vec4f(0.0);
    }
    let rings = ring_count(radius);
    let spacing = radius / (f32(rings) + 0.5);
    let edge = max(spacing, 1.0);
    var sum = vec4f(0.0);
    for (var ring = 1u; ring <= rings; ring++) {
        for (var step = 0u; step < 8u * ring; step++) {
            let offset = sample_offset(ring, step, spacing);
            let at = pixel + vec2i(offset);
            if !is_inside(at) {
                continue;
            }
            let sample = low[u32(at.y) * gather.low_width + u32(at.x)];
            let circle = abs(sample.w) / f32(gather.scale);
            let covers = saturate((circle - length(offset)) / edge + 0.5);
            let thinness = 0.5 * spacing / max(circle, 0.5 * spacing);
            let weight = in_front(sample.w, centre.w) * covers * thinness * thinness;
            sum += weight * vec4f(sample.xyz, 1.0);
        }
    }
    return sum / max(sum.w, 1.0);
}

@compute @workgroup_size(TILE, TILE)
fn gather_layers(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= gather.low_width || id.y >= gather.low_height {
        return;
    }
    let index = id.y * gather.low_width + id.x;
    let centre = low[index];
    let around = largest_around[(id.y / TILE) * gather.tiles_wide + id.x / TILE];
    let radius = max(around, centre.w / f32(gather.scale));
    behind[index] = vec4f(gather_behind(vec2i(id.xy), centre), 0.0);
    before[index] = gather_before(vec2i(id.xy), centre, radius);
}
