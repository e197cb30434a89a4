// Subsurface scattering gathered from pixels chosen by the profile, one invocation a pixel.
// The plain version is render/src/methods/gather/reference.rs; both do the same, line by line.

#import shared/bounded
#import shared/picture
#import shared/random
#import shared/translucent
#import uniforms/gather

@group(0) @binding(0) var<uniform> settings: Gather;
@group(0) @binding(5) var<storage, read> areas: array<f32>;
@group(0) @binding(6) var<storage, read_write> scattered: array<f32>;

const PI = 3.14159265;
// Angle between a sample and the next, turns: the golden section of the circle.
const GOLDEN_TURN = 0.381966;
// The share of the profile that is left out: what is farther away than 26.8 mean free paths.
const LEFT_OUT = 1e-4;

// Christensen and Burley's profile for the scale d at distance r > 0, per square metre.
fn profile(r: f32, d: f32) -> f32 {
    let slow = exp(-r / (3.0 * d));
    return (slow * slow * slow + slow) / (8.0 * PI * d * r);
}

// The share of the profile within a disc of radius r.
fn within(r: f32, d: f32) -> f32 {
    let slow = exp(-r / (3.0 * d));
    return 1.0 - 0.25 * slow * slow * slow - 0.75 * slow;
}

// The radius of the disc that holds a share of the profile: t = exp(-r / 3d) solves t^3 + 3 t = 4 (1 - share)
// (Cardano).
fn radius_of(share: f32, d: f32) -> f32 {
    let left = 2.0 * (1.0 - share);
    let root = pow(left + sqrt(left * left + 1.0), 1.0 / 3.0);
    return -3.0 * d * log(root - 1.0 / root);
}

// One colour of a pixel, given its mean free path d.
fn gather_channel(pixel: vec2i, centre: u32, channel: u32, d: f32) -> f32 {
    let pixels = settings.width * settings.height;
    let here = translucent_position(centre, pixels);
    let size = -here.z / settings.focal_length;
    // The pixel itself is no sample: its own share is known, and samples begin at its edge.
    let own = within(sqrt(areas[centre] / PI), d);
    let first = within(0.5 * size, d);
    let start = random(vec2u(pixel), settings.seed, 2u * channel);
    let turn = random(vec2u(pixel), settings.seed, 2u * channel + 1u);
    var light = own * light_planes[centre + channel * pixels];
    var weights = own;
    let samples = bounded(settings.samples, vec2u(pixel));
    for (var i = 0u; i < samples; i++) {
        let share = first + (1.0 - first) * (f32(i) + start) / f32(settings.samples);
        let radius = radius_of(min(share, 1.0 - LEFT_OUT), d);
        let angle = (fract(f32(i) * GOLDEN_TURN + turn) - 0.5) * (2.0 * PI);
        let offset = floor(radius / size * vec2f(cos(angle), sin(angle)) + 0.5);
        if all(offset == vec2f(0.0)) || any(abs(offset) > vec2f(f32(settings.width + settings.height))) {
            continue;
        }
        let at = pixel + vec2i(offset);
        if at.x < 0 || at.y < 0 || at.x >= i32(settings.width) || at.y >= i32(settings.height) {
            continue;
        }
        let index = u32(at.y) * settings.width + u32(at.x);
        let area = areas[index];
        if area == 0.0 {
            continue;
        }
        let apart = max(distance(translucent_position(index, pixels), here), sqrt(area / PI));
        let density = profile(radius, d) * size * size / (1.0 - first);
        let weight = area * profile(apart, d) / (density * f32(settings.samples));
        light += weight * light_planes[index + channel * pixels];
        weights += weight;
    }
    return light / weights;
}

@compute @workgroup_size(TILE, TILE)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
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
        scattered[index + channel * pixels] = value;
    }
}
