// Directional occlusion before its blur, one invocation a pixel (Ritschel, Grosch and Seidel 2009, section
// 3). The plain version is render/src/methods/ssdo/reference.rs; both do the same, line by line.

#import shared/bounded
#import shared/environment
#import shared/random
#import shared/surface
#import shared/surface_valid

/// What `methods/ssdo/light` reads.
struct Ssdo {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Directions of a pixel.
    directions: u32,
    /// Points along each.
    steps: u32,
    /// Chooses the random numbers.
    seed: u32,
    /// Radius up to which directions are marched, metres.
    radius: f32,
    /// How thick everything is taken to be, metres.
    thickness: f32,
    /// Distance in pixels, at depth 1, of two points one unit apart.
    focal_length: f32,
    /// Rows of the environment's map.
    environment_height: u32,
    /// The camera's x axis in world space, and so on.
    right_x: f32,
    /// Its y.
    right_y: f32,
    /// Its z.
    right_z: f32,
    /// The camera's y axis.
    up_x: f32,
    /// Its y.
    up_y: f32,
    /// Its z.
    up_z: f32,
    /// The camera's z axis, against the view.
    back_x: f32,
    /// Its y.
    back_y: f32,
    /// Its z.
    back_z: f32,
}

@group(0) @binding(0) var<uniform> ssdo: Ssdo;
// One map of ssdo.environment_height rows.
@group(0) @binding(4) var<storage, read> environment: array<vec4f>;
// Irradiance over pi, [3, height, width].
@group(0) @binding(5) var<storage, read_write> irradiance: array<f32>;

// Angle between a direction and the next, turns: the golden section of the circle.
const GOLDEN_TURN = 0.381966;

// Whether a point in camera space is behind a surface that the camera sees, and no further than that is
// thick.
fn is_hidden(point: vec3f) -> bool {
    let pixels = ssdo.width * ssdo.height;
    let middle = 0.5 * vec2f(f32(ssdo.width), f32(ssdo.height));
    let at = vec2i(floor(middle + vec2f(point.x, -point.y) * (ssdo.focal_length / -point.z)));
    if !(point.z < 0.0) || at.x < 0 || at.y < 0 || at.x >= i32(ssdo.width) || at.y >= i32(ssdo.height) {
        return false;
    }
    let index = u32(at.y) * ssdo.width + u32(at.x);
    if !surface_valid(index) {
        return false;
    }
    let position = surface_position(index, pixels);
    // Behind the plane of the pixel's surface, since the point is beside the ray through the pixel's middle,
    // by more than rounding.
    return dot(point - position, surface_normal(index, pixels)) < -1e-4 * ssdo.radius
        && length(point) - length(position) < ssdo.thickness;
}

// Whether one of the points along a direction is hidden; they are denser near the surface.
fn is_blocked(pixel: vec2u, position: vec3f, direction: vec3f, start: f32) -> bool {
    let steps = bounded(ssdo.steps, pixel);
    for (var step = 0u; step < steps; step++) {
        let share = (f32(step) + start) / f32(ssdo.steps);
        if is_hidden(position + ssdo.radius * share * share * direction) {
            return true;
        }
    }
    return false;
}

// From camera to world space.
fn to_world(v: vec3f) -> vec3f {
    return v.x * vec3f(ssdo.right_x, ssdo.right_y, ssdo.right_z) + v.y * vec3f(ssdo.up_x, ssdo.up_y, ssdo.up_z)
        + v.z * vec3f(ssdo.back_x, ssdo.back_y, ssdo.back_z);
}

@compute @workgroup_size(TILE, TILE)
fn gather_light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= ssdo.width || id.y >= ssdo.height {
        return;
    }
    let pixels = ssdo.width * ssdo.height;
    let index = id.y * ssdo.width + id.x;
    var light = vec3f(0.0);
    if surface_valid(index) {
        let position = surface_position(index, pixels);
        let normal = surface_normal(index, pixels);
        // Two tangents (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
        let sign = select(-1.0, 1.0, normal.z >= 0.0);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        let tangent = vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
        let bitangent = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
        let turn = random(id.xy, ssdo.seed, 0u);
        let shift = random(id.xy, ssdo.seed, 1u);
        let directions = bounded(ssdo.directions, id.xy);
        for (var k = 0u; k < directions; k++) {
            // A spiral over the disk, lifted onto the hemisphere, has the density cosine / pi (Malley's
            // method).
            let squared = (f32(k) + shift) / f32(ssdo.directions);
            let angle = TAU * (fract(GOLDEN_TURN * f32(k) + turn) - 0.5);
            let disk = sqrt(squared) * vec2f(cos(angle), sin(angle));
            let direction = disk.x * tangent + disk.y * bitangent + sqrt(1.0 - squared) * normal;
            if !is_blocked(id.xy, position, direction, random(id.xy, ssdo.seed, 2u + k)) {
                light += environment_radiance(0u, ssdo.environment_height, to_world(direction));
            }
        }
        light /= f32(ssdo.directions);
    }
    irradiance[index] = light.x;
    irradiance[index + pixels] = light.y;
    irradiance[index + 2u * pixels] = light.z;
}
