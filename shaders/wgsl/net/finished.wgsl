// An effect's image of what a run of a network made, both planar: in the light that the frame had before it
// was scaled, within the effect's range, with the effect's background where no surface is seen.

#template
#import shared/net_frame
#import shared/surface_valid

@group(0) @binding(1) var<storage, read> made: array<f32>;
@group(0) @binding(2) var<storage, read_write> image: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= frame.width || id.y >= frame.height) {
        return;
    }
    let pixels = frame.width * frame.height;
    let pixel = id.y * frame.width + id.x;
    let seen = surface_valid(pixel);
    for (var channel = 0u; channel < CHANNELS; channel++) {
        let value = clamp(made[pixel + channel * pixels] / frame.light_scale, LEAST, MOST);
        let at = pixel + (frame.run * CHANNELS + channel) * pixels;
        image[at] = select(value, BACKGROUND, HAS_BACKGROUND && !seen);
    }
}
