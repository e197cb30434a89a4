// The bounced z-buffer of a medium, one invocation for each of a pixel's rays: from a place on the view ray,
// drawn in intervals of equal loss of transmittance, into a direction drawn by the phase function, the light
// of the nearest surfel. The plain version is render/src/methods/bounced_z/fog/reference.rs.

#import shared/bounced_directions
#import shared/medium
#import shared/packing
#import shared/phase_direction
#import shared/surfel_nearest
#import shared/transmittance
#import shared/view
#import uniforms/frame_view
#import uniforms/medium_record
#constant LOOKUPS = 4
#constant SAMPLES = 16

@group(0) @binding(0) var<uniform> bounces: Bounces;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<uniform> medium: MediumRecord;
@group(0) @binding(3) var densities: texture_3d<f32>;
@group(0) @binding(4) var<storage, read> totals: Totals;
@group(0) @binding(5) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// Of the front and of the back, as `surfels/dimmed` has written it.
@group(0) @binding(7) var<storage, read> sent: array<vec2u>;
// The transmittance interval map: `shared/intervals`.
@group(0) @binding(8) var<storage, read> rays: array<vec4f>;
@group(0) @binding(9) var<storage, read> samples: array<array<u32, SAMPLES / 2u>>;
// [directions, height, width]: bits of a distance from the eye, metres, and the radiance that comes from
// there, as `pack_radiance` has it, were the transmittance's whole loss 1.
@group(0) @binding(10) var<storage, read_write> arrived: array<vec2u>;

// One over the root of x^4 = x + 1: with the spiral's turns it fills space evenly (Roberts 2018, "The
// Unreasonable Effectiveness of Quasirandom Sequences").
const STEP = 0.8191725;

// A place on a view ray.
struct Place {
    // From the eye, metres.
    distance: f32,
    // Density times length before it.
    passed: f32,
}

// A number in [0, 1) for each ray of a pixel, which those of a square fill evenly.
fn share_of(pixel: vec2u, number: u32) -> f32 {
    let which = IN_SQUARE * number + number_in_square(pixel, SQUARE, hash(bounces.seed));
    return fract(STEP * f32(which) + random(pixel >> vec2u(SQUARE), bounces.seed, 2u));
}

fn share_before(words: ptr<function, array<u32, SAMPLES / 2u>>, sample: u32) -> f32 {
    return f32(((*words)[sample / 2u] >> (16u * (sample % 2u))) & 65535u) / 65535.0;
}

// The place before which a share of the transmittance's whole loss lies. Within an interval density is taken
// to be even.
fn place_at(share: f32, at: u32) -> Place {
    var words = samples[at];
    let ray = rays[at];
    let least = mean_transmittance(ray.z);
    let interval = min(u32(share * f32(SAMPLES - 1u) + ray.w), SAMPLES - 2u);
    let begins = mix(ray.x, ray.y, share_before(&words, interval));
    let ends = mix(ray.x, ray.y, share_before(&words, interval + 1u));
    let before = passed_before(interval, ray.z, ray.w);
    let after = passed_before(interval + 1u, ray.z, ray.w);
    let extinction = dot(medium.extinction.rgb, vec3f(1.0 / 3.0));
    let passed = clamp(-log(1.0 - share * (1.0 - least)) / max(extinction, 1e-30), before, after);
    return Place(mix(begins, ends, (passed - before) / max(after - before, 1e-30)), passed);
}

// The radiance that scatters to the eye at a place, over the density of such places and directions.
fn arriving(place: Place, along: vec3f, turned: vec2f) -> vec3f {
    let point = place.distance * along;
    let direction = phase_direction(along, turned);
    let hit = nearest(Ray(point, vec3f(0.0), direction));
    if hit.surfel == NONE {
        return vec3f(0.0);
    }
    let word = met_word(hit, direction);
    let light = unpack_radiance(sent[word >> 1u][word & 1u]);
    let origin = view.eye.xyz + from_view(point, view);
    let between = passed_density(origin, from_view(direction, view), hit.distance, LOOKUPS);
    let extinction = medium.extinction.rgb;
    let usual = dot(extinction, vec3f(1.0 / 3.0));
    let scattered = medium.scattering.rgb / usual * exp((usual - extinction) * place.passed);
    return light * scattered * exp(-extinction * between);
}

@compute @workgroup_size(TILE, TILE)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= bounces.width || id.y >= bounces.height {
        return;
    }
    let at = id.y * bounces.width + id.x;
    let ray = rays[at];
    var found = vec2u(bitcast<u32>(ray.x), 0u);
    if ray.y > ray.x && mean_transmittance(ray.z) < 1.0 {
        let along = normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view));
        let place = place_at(share_of(id.xy, id.z), at);
        let turned = place_on_disk(id.xy, id.z, vec2u(bounces.directions, bounces.seed));
        found = vec2u(bitcast<u32>(place.distance), pack_radiance(arriving(place, along, turned)));
    }
    arrived[at + id.z * bounces.width * bounces.height] = found;
}
