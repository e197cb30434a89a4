// Whether a surface is seen at a pixel, and its gloss, as `methods/gloss` has gathered it.

// [height, width]: specular colour; glossiness, -1 where no surface is seen.
@group(0) @binding(3) var<storage, read> gloss: array<vec4f>;

fn surface_valid(index: u32) -> bool {
    return gloss[index].w >= 0.0;
}
