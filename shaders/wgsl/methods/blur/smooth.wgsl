// One direction of the blur that removes the noise of random samples: a Gaussian that fades with the distance
// from the pixel's tangent plane. The plain version is render/src/methods/blur.rs.

#import shared/bounded
#import shared/surface
#import shared/surface_valid
#constant CHANNELS = 1

/// What `methods/blur/smooth` reads.
struct Blur {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// 1 to blur along rows, else 0.
    step_x: i32,
    /// 1 to blur along columns, else 0.
    step_y: i32,
    /// Pixels on either side that are blurred together.
    radius: i32,
    /// The Gaussian's exponent of a distance of one pixel.
    falloff: f32,
    /// Factor, one over metres, of a distance from the tangent plane before it is squared into the exponent.
    sharpness: f32,
    /// Value where no surface is seen.
    background: f32,
}

@group(0) @binding(0) var<uniform> blur: Blur;
// [CHANNELS, height, width]
@group(0) @binding(4) var<storage, read> noisy: array<f32>;
@group(0) @binding(5) var<storage, read_write> smoothed: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn smooth_noise(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= blur.width || id.y >= blur.height {
        return;
    }
    let pixels = blur.width * blur.height;
    let centre = id.y * blur.width + id.x;
    if !surface_valid(centre) {
        for (var c = 0u; c < CHANNELS; c++) {
            smoothed[centre + c * pixels] = blur.background;
        }
        return;
    }
    let position = surface_position(centre, pixels);
    let normal = surface_normal(centre, pixels);
    var sums: array<f32, CHANNELS>;
    var weights = 0.0;
    let reach = i32(bounded(u32(blur.radius), id.xy));
    for (var i = -reach; i <= reach; i++) {
        let at = vec2i(id.xy) + i * vec2i(blur.step_x, blur.step_y);
        if at.x < 0 || at.y < 0 || at.x >= i32(blur.width) || at.y >= i32(blur.height) {
            continue;
        }
        let index = u32(at.y) * blur.width + u32(at.x);
        if !surface_alike(index, centre) {
            continue;
        }
        let off_plane = blur.sharpness * dot(normal, surface_position(index, pixels) - position);
        let weight = exp(-(blur.falloff * f32(i * i) + off_plane * off_plane));
        for (var c = 0u; c < CHANNELS; c++) {
            sums[c] += weight * noisy[index + c * pixels];
        }
        weights += weight;
    }
    for (var c = 0u; c < CHANNELS; c++) {
        smoothed[centre + c * pixels] = sums[c] / weights;
    }
}
