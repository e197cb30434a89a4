// Slices of what a pixel's surface sees, marched through the g-buffer into bitmasks of cosine-weighted
// sectors. What that means, and the plain version, is in render/src/methods/slices.rs. A pass that includes
// this says, in a function `sent(index: u32, toward: vec3f) -> vec3f`, what the surface at a pixel sends to a
// receiver; `toward` is from the receiver to it.

#import shared/bounded
#import shared/random
#import shared/surface
#import shared/surface_valid

/// What `shared/slices` reads.
struct Slices {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Slices of a pixel.
    slices: u32,
    /// Most samples on either side of a slice.
    steps: u32,
    /// Chooses the random numbers.
    seed: u32,
    /// Radius within which a sample counts, metres.
    radius: f32,
    /// How thick everything is taken to be, metres.
    thickness: f32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
}

@group(0) @binding(0) var<uniform> slices: Slices;

const PI = 3.14159265;

// The sectors of a slice: the bits of a mask.
const SECTORS = 32.0;

// The normal in the plane of the direction to the eye and one across it: cosine and sine of its angle from
// the one towards the other, the angle, and the length of its projection onto the plane.
struct Tilt {
    cosine: f32,
    sine: f32,
    angle: f32,
    length: f32,
}

struct Gathered {
    // Cosine-weighted share of all directions that is open.
    open: f32,
    // Mean over all directions of what is sent from them, cosine-weighted.
    light: vec3f,
}

// Within 7e-5 (Abramowitz and Stegun 1964, 4.4.45): the same on every device.
fn arc_cosine(x: f32) -> f32 {
    let a = min(abs(x), 1.0);
    let angle = sqrt(1.0 - a) * (1.5707288 + a * (-0.2121144 + a * (0.0742610 - 0.0187293 * a)));
    return select(angle, PI - angle, x < 0.0);
}

fn tilt_of(normal: vec3f, to_eye: vec3f, across: vec3f) -> Tilt {
    // A normal that looks away from the eye is taken for one at a right angle.
    let upright = max(dot(normal, to_eye), 0.0);
    let aside = dot(normal, across);
    let length = max(sqrt(upright * upright + aside * aside), 1e-6);
    let sine = clamp(aside / length, -1.0, 1.0);
    return Tilt(upright / length, sine, 0.5 * PI - arc_cosine(sine), length);
}

// Integral over a slice of the cosine to the normal's projection times the slice's width.
fn extent_of(tilt: Tilt) -> f32 {
    return tilt.cosine + tilt.angle * tilt.sine;
}

// The share of a slice's cosine-weighted directions before a unit direction in its half `across`; 1 at the
// horizon.
fn place(direction: vec3f, to_eye: vec3f, across: vec3f, normal: vec3f, tilt: Tilt) -> f32 {
    if dot(direction, normal) <= 0.0 {
        return 1.0;
    }
    let cosine = dot(direction, to_eye);
    let sine = dot(direction, across);
    let doubled = (2.0 * cosine * cosine - 1.0) * tilt.cosine + 2.0 * sine * cosine * tilt.sine;
    let before = 0.75 * tilt.cosine - 0.25 * doubled
        + 0.5 * tilt.sine * (arc_cosine(cosine) + tilt.angle - 0.5 * PI);
    return clamp(before / extent_of(tilt), 0.0, 1.0);
}

// The sectors, from the middle of a slice outwards, that the surface at `at` covers, seen from `position`. It
// is `thickness` thick along the ray from the eye, and ends at the radius.
fn covered_by(at: vec3f, position: vec3f, normal: vec3f, to_eye: vec3f, jitter: f32) -> u32 {
    let toward = at - position;
    let distance = length(toward);
    if !(distance > 0.0 && distance < slices.radius) || dot(toward, normal) <= 0.0 {
        return 0u;
    }
    let aside = toward - dot(toward, to_eye) * to_eye;
    let across = aside / max(length(aside), 1e-20);
    let tilt = tilt_of(normal, to_eye, across);
    let along_ray = normalize(at);
    let inward = dot(toward, along_ray);
    let to_radius = sqrt(inward * inward + slices.radius * slices.radius - distance * distance) - inward;
    let behind = toward + min(slices.thickness, to_radius) * along_ray;
    let first = place(toward / distance, to_eye, across, normal, tilt);
    let last = place(normalize(behind), to_eye, across, normal, tilt);
    let low = min(u32(SECTORS * first + jitter), 32u);
    let high = min(u32(SECTORS * last + jitter), 32u);
    return select(0xffffffffu >> (32u - (high - low)), 0u, high <= low) << (low & 31u);
}

// Pixels that may be marched in a direction of the image: as far as the radius reaches and the image goes on.
fn reach_of(pixel: vec2u, depth: f32, direction: vec2f) -> f32 {
    let squared = depth * depth - slices.radius * slices.radius;
    let radius = slices.focal_length * slices.radius / sqrt(max(squared, 1e-6 * depth * depth));
    let last = vec2f(f32(slices.width), f32(slices.height)) - 1.0;
    let pixels = select(vec2f(pixel), last - vec2f(pixel), direction > vec2f(0.0));
    let edge = pixels / max(abs(direction), vec2f(1e-6));
    return min(radius, min(edge.x, edge.y));
}

fn gather(pixel: vec2u) -> Gathered {
    let pixels = slices.width * slices.height;
    let index = pixel.y * slices.width + pixel.x;
    let position = surface_position(index, pixels);
    let normal = surface_normal(index, pixels);
    let to_eye = -normalize(position);
    let right = normalize(vec3f(to_eye.z, 0.0, -to_eye.x));
    let up = cross(to_eye, right);
    let turn = random(pixel, slices.seed, 0u);
    var gathered = Gathered(0.0, vec3f(0.0));
    var weights = 0.0;
    let count_of_slices = bounded(slices.slices, pixel);
    for (var k = 0u; k < count_of_slices; k++) {
        let angle = (f32(k) + turn) * (PI / f32(slices.slices));
        let start = random(pixel, slices.seed, 1u + 2u * k);
        let jitter = random(pixel, slices.seed, 2u + 2u * k);
        let axis = cos(angle) * right + sin(angle) * up;
        let tilt = tilt_of(normal, to_eye, axis);
        let weight = tilt.length * extent_of(tilt);
        var covered = 0u;
        for (var side = 0u; side < 2u; side++) {
            let across = select(axis, -axis, side == 1u);
            // Where the image of a point goes that moves across; image y points down, camera y up.
            let moved = across.xy - position.xy * (across.z / position.z);
            let direction = normalize(vec2f(moved.x, -moved.y));
            let reach = reach_of(pixel, -position.z, direction);
            if !(reach >= 1.0) {
                continue;
            }
            let count = min(slices.steps, u32(reach));
            for (var step = 0u; step < count; step++) {
                let share = (f32(step) + start) / f32(count);
                let offset = floor(direction * (1.0 + (reach - 1.0) * share * share) + 0.5);
                let at = vec2i(pixel) + vec2i(offset);
                if at.x < 0 || at.y < 0 || at.x >= i32(slices.width) || at.y >= i32(slices.height) {
                    break;
                }
                let there = u32(at.y) * slices.width + u32(at.x);
                if !surface_valid(there) {
                    continue;
                }
                let sender = surface_position(there, pixels);
                let outward = covered_by(sender, position, normal, to_eye, jitter);
                let sectors = select(outward, reverseBits(outward), side == 1u) & ~covered;
                if sectors != 0u {
                    covered |= sectors;
                    let share_of_all = weight * f32(countOneBits(sectors)) / SECTORS;
                    gathered.light += share_of_all * sent(there, sender - position);
                }
            }
        }
        gathered.open += weight * f32(countOneBits(~covered)) / SECTORS;
        weights += weight;
    }
    return Gathered(gathered.open / weights, gathered.light / weights);
}
