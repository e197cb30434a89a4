// What a surfel gives a point through the body below both (thesis 4.3, "Multiple Scattering"): a share of its
// light, for red, green and blue apart, by the profile of Christensen and Burley 2015 at its distance times
// its area; and that share. What lies on the point's side of the body apart from what lies on the other.

#import shared/packing
#import shared/surface
#import shared/surfel_record

// [4, height, width]: how far light goes below the surface, metres, red, green and blue; the object.
@group(0) @binding(3) var<storage, read> bodies: array<f32>;
// Light that falls on surfels, as white ones reflect it; the object that they are part of.
@group(0) @binding(8) var<storage, read> sent: array<vec2u>;

// Beyond so many lengths less than a thousandth of the profile is left: 3 exp(-r / (3 d)) / 4.
const SUPPORT = 19.9;

// A closed surface is met from within if that is so from below the pixel's: so far, over the distance, and
// over the height above it, that what lies in a plane or a hollow is.
const BELOW_PLANE = 0.02;
const BELOW_HOLLOW = 3.0;

struct Receiver {
    position: vec3f,
    normal: vec3f,
    // Metres; 0 where nothing is seen or no light enters.
    reach: f32,
    // The profile's `d` of each colour, metres.
    scales: vec3f,
    object: f32,
}

fn receiver_at(at: u32, pixels: u32) -> Receiver {
    let position = surface_position(at, pixels);
    let normal = surface_normal(at, pixels);
    let scales = vec3f(bodies[at], bodies[at + pixels], bodies[at + 2u * pixels]);
    let reach = min(level.reach, SUPPORT * max(scales.x, max(scales.y, scales.z)));
    return Receiver(position, normal, reach, scales, bodies[at + 3u * pixels]);
}

// Light, and the shares of the profile that it came by, of one side, then of the other.
fn nothing() -> mat4x3f {
    return mat4x3f(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
}

// The profile (exp(-r / d) + exp(-r / (3 d))) / (8 pi d r) times the area of a disk; of a colour that does
// not enter, 0.
fn profile_share(radius: f32, distance: f32, scales: vec3f) -> vec3f {
    let d = max(scales, vec3f(1e-20));
    let slow = exp(-distance / (3.0 * d));
    let share = (slow * slow * slow + slow) * (radius * radius / (8.0 * distance)) / d;
    return select(vec3f(0.0), share, scales > vec3f(0.0));
}

// What of a surfel lies on the other side of a receiver's body: of a closed one what faces another way, of
// sheets, whose triangles may face either, what lies below the receiver by more than it is large.
fn far_share(surfel: Surfel, normal: vec3f, way: vec3f, receiver: Receiver) -> f32 {
    let averted = 0.5 - 2.0 * dot(receiver.normal, normal);
    let below = -dot(way, receiver.normal) / max(surfel_radius(surfel), 1e-20) - 0.5;
    return clamp(select(averted, below, surfel_is_open(surfel)), 0.0, 1.0);
}

fn added(sum: mat4x3f, which: u32, way: vec3f, squared: f32, receiver: Receiver) -> mat4x3f {
    let surfel = surfels[which];
    let radius = surfel_radius(surfel);
    let distance = sqrt(squared);
    // What is nearer than a surfel is large is the pixel's own.
    if distance <= radius || f32(sent[which].y) != receiver.object {
        return sum;
    }
    let below = BELOW_PLANE * distance + BELOW_HOLLOW * max(dot(way, receiver.normal), 0.0);
    let normal = surfel_normal(surfel);
    let outwards = dot(way + below * receiver.normal, normal);
    if outwards < 0.0 && !surfel_is_open(surfel) {
        return sum;
    }
    let share = profile_share(radius, distance, receiver.scales);
    let light = share * unpack_radiance(sent[which].x);
    let far = far_share(surfel, normal, way, receiver);
    return sum + mat4x3f((1.0 - far) * light, (1.0 - far) * share, far * light, far * share);
}

fn write_sum(sum: mat4x3f, at: u32, pixels: u32) {
    for (var c = 0u; c < 3u; c++) {
        sums[at + c * pixels] = sum[0][c];
        sums[at + (c + 3u) * pixels] = sum[1][c];
        sums[at + (c + 6u) * pixels] = sum[2][c];
        sums[at + (c + 9u) * pixels] = sum[3][c];
    }
}
