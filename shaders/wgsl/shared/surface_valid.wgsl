// Whether a surface is seen at a pixel, by the g-buffer's mask, [height, width].

@group(0) @binding(3) var<storage, read> valid_plane: array<f32>;

fn surface_valid(index: u32) -> bool {
    return valid_plane[index] > 0.5;
}
