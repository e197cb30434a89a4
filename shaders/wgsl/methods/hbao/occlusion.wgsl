// Horizon-based ambient occlusion before its blur, one invocation a pixel (Bavoil, Sainz and Dimitrov 2008).
// The plain version is render/src/methods/hbao/reference.rs; both do the same, line by line.

#import shared/bounded
#import shared/random
#import shared/surface
#import shared/surface_valid

/// What `methods/hbao/occlusion` reads.
struct Hbao {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Directions that are marched.
    directions: u32,
    /// Most samples of a direction.
    steps: u32,
    /// Chooses the random numbers.
    seed: u32,
    /// Radius within which a sample can occlude, metres.
    radius: f32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
    /// Sine of the angle bias.
    bias_sine: f32,
    /// Cosine of the angle bias.
    bias_cosine: f32,
    /// Factor of the occlusion.
    strength: f32,
}

@group(0) @binding(0) var<uniform> hbao: Hbao;
@group(0) @binding(4) var<storage, read_write> openness: array<f32>;

const PI = 3.14159265;

// Sine of the elevation, above the image plane, of the tangent plane towards another pixel, plus the bias.
fn biased_tangent(position: vec3f, normal: vec3f, offset: vec2f) -> f32 {
    // The tangent plane cut along the offset; image y points down, camera y up.
    let across = vec3f(offset.x, -offset.y, 0.0);
    let sine = normalize(dot(normal, across) * position - dot(normal, position) * across).z;
    // Elevations end at the zenith.
    if sine >= hbao.bias_cosine {
        return 1.0;
    }
    return sine * hbao.bias_cosine + sqrt(max(1.0 - sine * sine, 0.0)) * hbao.bias_sine;
}

// What occludes the pixel in one direction of the image: how far samples rise above the tangent, in sines;
// each rise above all before it weighted by how near its sample is. Pixels lie on a grid and not on the
// direction, so each is measured from the tangent towards itself.
fn march(pixel: vec2i, position: vec3f, normal: vec3f, direction: vec2f, start: f32, spacing: f32, count: u32) -> f32 {
    let pixels = hbao.width * hbao.height;
    var horizon = 0.0;
    var occlusion = 0.0;
    for (var step = 0u; step < count; step++) {
        let distance = (f32(step) + start) * spacing;
        let offset = floor(direction * distance + 0.5);
        let at = pixel + vec2i(offset);
        if at.x < 0 || at.y < 0 || at.x >= i32(hbao.width) || at.y >= i32(hbao.height) {
            break;
        }
        let index = u32(at.y) * hbao.width + u32(at.x);
        if all(offset == vec2f(0.0)) || !surface_valid(index) {
            continue;
        }
        let toward = surface_position(index, pixels) - position;
        let reach = length(toward);
        let rise = toward.z / reach - biased_tangent(position, normal, offset);
        if reach < hbao.radius && rise > horizon {
            let nearness = 1.0 - (reach * reach) / (hbao.radius * hbao.radius);
            occlusion += nearness * (rise - horizon);
            horizon = rise;
        }
    }
    return occlusion;
}

@compute @workgroup_size(TILE, TILE)
fn occlude(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= hbao.width || id.y >= hbao.height {
        return;
    }
    let pixels = hbao.width * hbao.height;
    let index = id.y * hbao.width + id.x;
    openness[index] = 1.0;
    if !surface_valid(index) {
        return;
    }
    let position = surface_position(index, pixels);
    let normal = surface_normal(index, pixels);
    // The radius in pixels; a circle larger than the image would only thin out the samples.
    let extent = min(hbao.radius * hbao.focal_length / -position.z, f32(hbao.width + hbao.height));
    if !(extent >= 1.0) {
        return;
    }
    let count = min(hbao.steps, u32(extent));
    let spacing = extent / f32(count);
    let turn = random(id.xy, hbao.seed, 0u);
    let start = random(id.xy, hbao.seed, 1u);
    var occlusion = 0.0;
    let directions = bounded(hbao.directions, id.xy);
    for (var k = 0u; k < directions; k++) {
        let angle = (f32(k) + turn) * (2.0 * PI / f32(hbao.directions)) - PI;
        occlusion += march(vec2i(id.xy), position, normal, vec2f(cos(angle), sin(angle)), start, spacing, count);
    }
    openness[index] = clamp(1.0 - hbao.strength * occlusion / f32(hbao.directions), 0.0, 1.0);
}
