// The effect's radius in pixels, and the image's border.

#import shared/net_frame

// What logarithms of pixels are divided by.
const OCTAVES = 8.0;
// The smallest radius in pixels that is told from smaller ones.
const LEAST_PIXELS = 0.25;

// How many pixels the radius covers at a depth above 0.
fn radius_in_pixels(depth: f32) -> f32 {
    return frame.focal_length * frame.radius / depth;
}

// The logarithm of that; 0 where nothing is seen.
fn pixel_radius(depth: f32) -> f32 {
    if (!(depth > 0.0)) {
        return 0.0;
    }
    return log2(max(radius_in_pixels(depth), LEAST_PIXELS)) / OCTAVES;
}

// The way to the image's nearest border in radii, at most 1; 0 where nothing is seen.
fn border(at: vec2u, depth: f32) -> f32 {
    if (!(depth > 0.0)) {
        return 0.0;
    }
    let nearest = min(at, vec2u(frame.width, frame.height) - 1u - at);
    return min((f32(min(nearest.x, nearest.y)) + 0.5) / radius_in_pixels(depth), 1.0);
}
