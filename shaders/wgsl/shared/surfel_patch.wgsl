// How many surfels a patch gets, and where they lie.

#import shared/patch_corners
#import shared/surfel
#import shared/surfel_patch_record

// A patch gets no more surfels; each is larger then.
const MOST = 4096.0;
// How far a surfel's chance has to rise above its threshold until it is as large as it gets, as a share.
const RISE = 0.25;
// Makes the mean over all thresholds right: 1 / (4 (ln 1.25 + 1 / 1.25 - 1) + 1 / 1.25).
const LARGEST = 1.12035501;

struct Laid {
    // The whole triangle's corners, camera space.
    corners: mat3x3f,
    // Each column weighs the triangle's corners to give one of the patch's.
    weights: mat3x3f,
    area: f32,
    // Of a surfel of the size that is wanted there.
    radius: f32,
}

// How far a point of camera space is outside of what is seen, metres; negative inside.
fn outside(point: vec3f) -> f32 {
    let slopes = vec2f(settings.slope_x, settings.slope_y);
    let beyond = (abs(point.xy) * slopes + point.z) / sqrt(1.0 + slopes * slopes);
    return max(beyond.x, beyond.y);
}

// r* = s tan(alpha / 2) (d + d_near) with the unsigned distance to the near plane (thesis 4.2.1), so that
// what is behind the camera has surfels too, but no more than MOST. Beyond the paper's, what is not seen is
// as much farther as it is outside: of all that lies beside the camera there would be millions.
fn target_radius(middle: vec3f, area: f32) -> f32 {
    let distance = abs(middle.z + settings.near) + settings.near + max(outside(middle), 0.0);
    return max(settings.slope * distance, sqrt(area / (PI * MOST)));
}

fn laid(one: Patch) -> Laid {
    var it: Laid;
    it.corners = mat3x3f(
        camera_space(one.corners[0]), camera_space(one.corners[1]), camera_space(one.corners[2])
    );
    it.weights = patch_weights(one.part);
    let triangle = 0.5 * length(cross(it.corners[1] - it.corners[0], it.corners[2] - it.corners[0]));
    it.area = triangle * exp2(-2.0 * f32(one.part >> 28u));
    let middle = it.corners * ((it.weights[0] + it.weights[1] + it.weights[2]) / 3.0);
    it.radius = target_radius(middle, it.area);
    return it;
}
