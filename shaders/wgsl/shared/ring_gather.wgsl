// Circles of confusion of the picture's pixels.

#import shared/picture
#import uniforms/ring_gather

@group(0) @binding(0) var<uniform> gather: RingGather;
@group(0) @binding(3) var<storage, read> depth_plane: array<f32>;
@group(0) @binding(4) var<storage, read> blurriness_plane: array<f32>;

// Signed radius of the circle that a pixel's surface becomes, pixels of the image: negative in front of the
// plane in focus. What is not seen is infinitely far away.
fn circle(index: u32) -> f32 {
    if !picture_valid(index) {
        return min(gather.blur_at_infinity, gather.largest);
    }
    return clamp(blurriness_plane[index] / depth_plane[index], -gather.largest, gather.largest);
}
