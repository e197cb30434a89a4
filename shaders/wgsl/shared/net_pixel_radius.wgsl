// Lengths in pixels, and the image's border.

#import shared/net_frame

// What logarithms of pixels are divided by.
const OCTAVES = 8.0;
// The smallest radius in pixels that is told from smaller ones.
const LEAST_PIXELS = 0.25;

// How many pixels the radius covers at a depth above 0.
fn radius_in_pixels(depth: f32) -> f32 {
    return frame.focal_length * frame.radius / depth;
}

// The logarithm of how many pixels a length covers; 0 where nothing is seen.
fn logarithm_of_pixels(length: f32, depth: f32) -> f32 {
    if (!(depth > 0.0)) {
        return 0.0;
    }
    return log2(max(frame.focal_length * length / depth, LEAST_PIXELS)) / OCTAVES;
}

// That of the radius.
fn pixel_radius(depth: f32) -> f32 {
    return logarithm_of_pixels(frame.radius, depth);
}

// The way to the image's nearest border in radii, at most 1; 0 where nothing is seen.
fn border(at: vec2u, depth: f32) -> f32 {
    if (!(depth > 0.0)) {
        return 0.0;
    }
    let nearest = min(at, vec2u(frame.width, frame.height) - 1u - at);
    return min((f32(min(nearest.x, nearest.y)) + 0.5) / radius_in_pixels(depth), 1.0);
}
