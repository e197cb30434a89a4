// Temporal reprojection of any image, planes [CHANNELS, height, width]: what the frame before made of the
// surface that a pixel shows, mixed with what this one makes. The plain version is
// render/src/screen/reprojection/reference.rs.

#constant CHANNELS = 1

/// What `frame/reproject` reads.
struct Reprojection {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// 1 in the first frame, which has none before it.
    first: u32,
    /// Share of this frame in what is made of it.
    share: f32,
    /// Difference in depth, as a share of it, above which a pixel showed another surface.
    depth_tolerance: f32,
    /// Standard deviations of the pixels around, beyond which what was is cut off.
    clip: f32,
}

@group(0) @binding(0) var<uniform> mixing: Reprojection;
@group(0) @binding(1) var<storage, read> current: array<f32>;
@group(0) @binding(2) var<storage, read> history: array<f32>;
// Movement, depth, and depth before, of this frame, and of the one before.
@group(0) @binding(3) var<storage, read> since_before: array<f32>;
@group(0) @binding(4) var<storage, read> since_before_that: array<f32>;
@group(0) @binding(5) var<storage, read_write> mixed: array<f32>;

// Where the pixel's surface was: four pixels of the frame before with bilinear weights, 0 for those that
// showed another surface.
struct Origin {
    indices: array<u32, 4>,
    weights: array<f32, 4>,
    sum: f32,
}

fn origin_of(pixel: vec2u, pixels: u32) -> Origin {
    let index = pixel.y * mixing.width + pixel.x;
    // What the surface had then, not now: what comes nearer keeps its history.
    let depth = since_before[index + 3u * pixels];
    let at = vec2f(pixel) - vec2f(since_before[index], -since_before[index + pixels]);
    let corner = floor(at);
    let part = at - corner;
    var origin: Origin;
    for (var i = 0u; i < 4u; i++) {
        let tap = vec2i(corner) + vec2i(i32(i & 1u), i32(i >> 1u));
        if tap.x < 0 || tap.y < 0 || tap.x >= i32(mixing.width) || tap.y >= i32(mixing.height) {
            continue;
        }
        let tap_index = u32(tap.y) * mixing.width + u32(tap.x);
        let was = since_before_that[tap_index + 2u * pixels];
        if was <= 0.0 || abs(was - depth) > mixing.depth_tolerance * depth {
            continue;
        }
        let across = select(1.0 - part.x, part.x, (i & 1u) == 1u);
        let down = select(1.0 - part.y, part.y, (i >> 1u) == 1u);
        origin.indices[i] = tap_index;
        origin.weights[i] = across * down;
        origin.sum += across * down;
    }
    return origin;
}

// Mean and standard deviation of a channel over the pixels around one.
fn spread_around(pixel: vec2u, plane: u32) -> vec2f {
    var sum = 0.0;
    var squares = 0.0;
    var count = 0.0;
    for (var i = 0; i < 9; i++) {
        let at = vec2i(pixel) + vec2i(i % 3 - 1, i / 3 - 1);
        if at.x < 0 || at.y < 0 || at.x >= i32(mixing.width) || at.y >= i32(mixing.height) {
            continue;
        }
        let value = current[plane + u32(at.y) * mixing.width + u32(at.x)];
        sum += value;
        squares += value * value;
        count += 1.0;
    }
    let mean = sum / count;
    return vec2f(mean, sqrt(max(squares / count - mean * mean, 0.0)));
}

@compute @workgroup_size(TILE, TILE)
fn reproject(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= mixing.width || id.y >= mixing.height {
        return;
    }
    let pixels = mixing.width * mixing.height;
    let index = id.y * mixing.width + id.x;
    let origin = origin_of(id.xy, pixels);
    let known = since_before[index + 3u * pixels] > 0.0 && origin.sum > 0.01 && mixing.first == 0u;
    for (var c = 0u; c < CHANNELS; c++) {
        let plane = c * pixels;
        let value = current[plane + index];
        if !known {
            mixed[plane + index] = value;
            continue;
        }
        var was = 0.0;
        for (var i = 0u; i < 4u; i++) {
            if origin.weights[i] > 0.0 {
                was += origin.weights[i] * history[plane + origin.indices[i]];
            }
        }
        let around = spread_around(id.xy, plane);
        let reach = mixing.clip * around.y;
        let clipped = clamp(was / origin.sum, around.x - reach, around.x + reach);
        mixed[plane + index] = clipped + mixing.share * (value - clipped);
    }
}
