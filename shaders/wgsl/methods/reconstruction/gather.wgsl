// What a pixel shows while the shutter is open: what its own surface leaves bare as it moves, and what passes
// in front. The plain version is render/src/methods/reconstruction/reference.rs; both do the same, line by
// line.

#import shared/bounded
#import shared/motion
#import shared/picture
#import shared/random

@group(0) @binding(4) var<storage, read> depth_plane: array<f32>;
@group(0) @binding(5) var<storage, read> longest_around: array<vec3f>;
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

// Metres; nothing seen is farther than everything.
fn depth_of(index: u32) -> f32 {
    return select(1e30, depth_plane[index], picture_valid(index));
}

// Whether a depth is in front of another, softly (McGuire et al. 2012, softDepthCompare, of shares of the
// depth).
fn in_front(depth: f32, other: f32) -> f32 {
    return saturate((other - depth) / (settings.depth_extent * min(depth, other)));
}

// Offset of a sample on a line through the pixel, pixels, and the pixel there: one of as many equal parts of
// the line as there are samples.
fn sample_offset(step: u32, jitter: f32, line: vec2f) -> vec2f {
    let share = (f32(step) + jitter) / f32(settings.samples);
    return floor((2.0 * share - 1.0) * line + 0.5);
}

fn is_inside(at: vec2i) -> bool {
    return at.x >= 0 && at.y >= 0 && at.x < i32(settings.width) && at.y < i32(settings.height);
}

// Mean along the pixel's own movement of all that is not in front of it: its surface while that is there, and
// what is behind while it is not.
fn gather_behind(pixel: vec2i, centre: u32, jitter: f32) -> vec3f {
    let pixels = settings.width * settings.height;
    let movement = half_movement(centre);
    let own = picture_light(centre, pixels);
    if !picture_valid(centre) || movement.z < 0.5 {
        return own;
    }
    let depth = depth_of(centre);
    var light = vec3f(0.0);
    var weights = 0.0;
    let samples = bounded(settings.samples, vec2u(pixel));
    for (var step = 0u; step < samples; step++) {
        let at = pixel + vec2i(sample_offset(step, jitter, movement.xy));
        if !is_inside(at) {
            continue;
        }
        let index = u32(at.y) * settings.width + u32(at.x);
        let weight = 1.0 - in_front(depth_of(index), depth);
        light += weight * picture_light(index, pixels);
        weights += weight;
    }
    if weights == 0.0 {
        return own;
    }
    return light / weights;
}

// Every sample in front that passes over the pixel gives its light for as long as it is there, as a share of
// the exposure.
fn gather_before(pixel: vec2i, centre: u32, jitter: f32) -> vec4f {
    let pixels = settings.width * settings.height;
    let tile = vec2u(pixel) / settings.tile;
    let line = longest_around[tile.y * settings.tiles_wide + tile.x];
    if line.z < 0.5 {
        return vec4f(0.0);
    }
    let direction = line.xy / line.z;
    let spacing = 2.0 * line.z / f32(settings.samples);
    let edge = max(spacing, 1.0);
    let depth = depth_of(centre);
    var sum = vec4f(0.0);
    let samples = bounded(settings.samples, vec2u(pixel));
    for (var step = 0u; step < samples; step++) {
        let offset = sample_offset(step, jitter, line.xy);
        let at = pixel + vec2i(offset);
        if !is_inside(at) {
            continue;
        }
        let index = u32(at.y) * settings.width + u32(at.x);
        if !picture_valid(index) {
            continue;
        }
        let movement = half_movement(index);
        let along = abs(dot(movement.xy, direction));
        if along < 0.5 {
            continue;
        }
        let covers = saturate((along - length(offset)) / edge + 0.5);
        let duration = min(spacing / (2.0 * along), 1.0) * along / movement.z;
        let weight = in_front(depth_of(index), depth) * covers * duration;
        sum += weight * vec4f(picture_light(index, pixels), 1.0);
    }
    return sum / max(sum.w, 1.0);
}

@compute @workgroup_size(TILE, TILE)
fn expose(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.width || id.y >= settings.height {
        return;
    }
    let pixels = settings.width * settings.height;
    let index = id.y * settings.width + id.x;
    let jitter = random(id.xy, settings.seed, 0u);
    let behind = gather_behind(vec2i(id.xy), index, jitter);
    let before = gather_before(vec2i(id.xy), index, jitter);
    let mixed = before.xyz + (1.0 - before.w) * behind;
    image[index] = mixed.x;
    image[index + pixels] = mixed.y;
    image[index + 2u * pixels] = mixed.z;
}
