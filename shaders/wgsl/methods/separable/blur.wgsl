// One of the two passes of separable subsurface scattering: along rows, then along columns (Jimenez et al.
// 2015). The plain version is render/src/methods/separable/reference.rs; both do the same, line by line. The
// light that is blurred is the shared file's: of the picture first, then what the first pass wrote.

#import shared/bounded
#import shared/picture
#import shared/translucent
#constant MOST_TAPS = 25

/// What `methods/separable/blur` reads.
struct Separable {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// 1 to blur along rows, else 0.
    step_x: i32,
    /// 1 to blur along columns, else 0.
    step_y: i32,
    /// Taps on one side, the middle among them.
    taps: u32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
    /// The exponent of what is a mean free path farther away in space than on the screen.
    follow: f32,
}

@group(0) @binding(0) var<uniform> settings: Separable;
// Distances, in mean free paths, and the share of the profile that each stands for on one side.
@group(0) @binding(5) var<uniform> taps: array<vec4f, MOST_TAPS>;
@group(0) @binding(6) var<storage, read_write> blurred: array<f32>;

// One colour of a pixel, given its mean free path.
fn gather_channel(pixel: vec2i, centre: u32, channel: u32, mean_free_path: f32) -> f32 {
    let pixels = settings.width * settings.height;
    let here = translucent_position(centre, pixels);
    let size = -here.z / settings.focal_length;
    let own = light_planes[centre + channel * pixels];
    var light = taps[0].y * own;
    var weights = taps[0].y;
    let count = bounded(settings.taps, vec2u(pixel));
    for (var tap = 1u; tap < count; tap++) {
        let offset = floor(taps[tap].x * mean_free_path / size + 0.5);
        for (var side = -1; side <= 1; side += 2) {
            let at = pixel + side * i32(offset) * vec2i(settings.step_x, settings.step_y);
            if at.x < 0 || at.y < 0 || at.x >= i32(settings.width) || at.y >= i32(settings.height) {
                continue;
            }
            let index = u32(at.y) * settings.width + u32(at.x);
            if !picture_valid(index) {
                continue;
            }
            // Farther away in space than on the screen: less of the profile is left.
            let farther = max(distance(translucent_position(index, pixels), here) - offset * size, 0.0);
            let weight = taps[tap].y * exp(-settings.follow * farther / mean_free_path);
            light += weight * light_planes[index + channel * pixels];
            weights += weight;
        }
    }
    return light / weights;
}

@compute @workgroup_size(TILE, TILE)
fn scatter_along(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.width || id.y >= settings.height {
        return;
    }
    let pixels = settings.width * settings.height;
    let index = id.y * settings.width + id.x;
    let light = picture_light(index, pixels);
    for (var channel = 0u; channel < 3u; channel++) {
        let mean_free_path = mean_free_path_planes[index + channel * pixels];
        var value = light[channel];
        if picture_valid(index) && mean_free_path > 0.0 {
            value = gather_channel(vec2i(id.xy), index, channel, mean_free_path);
        }
        blurred[index + channel * pixels] = value;
    }
}
