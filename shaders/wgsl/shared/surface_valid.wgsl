// Whether a surface is seen at a pixel, by the g-buffer's mask, [height, width], or one that tells kinds of
// surfaces apart.

@group(0) @binding(3) var<storage, read> valid_plane: array<f32>;

fn surface_valid(index: u32) -> bool {
    return valid_plane[index] > 0.5;
}

// Whether one is seen of the same kind as at another pixel.
fn surface_alike(index: u32, other: u32) -> bool {
    return surface_valid(index) && floor(valid_plane[index] + 0.5) == floor(valid_plane[other] + 0.5);
}
