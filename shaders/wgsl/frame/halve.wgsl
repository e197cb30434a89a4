// Every second pixel of every second row of what a g-buffer has of an attribute.

#import uniforms/upsampling
#constant CHANNELS = 1

@group(0) @binding(0) var<uniform> settings: Upsampling;
// [CHANNELS, height, width]
@group(0) @binding(1) var<storage, read> full: array<f32>;
// [CHANNELS, small height, small width]
@group(0) @binding(2) var<storage, read_write> few: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn halve(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.small_width || id.y >= settings.small_height {
        return;
    }
    let pixels = settings.width * settings.height;
    let small_pixels = settings.small_width * settings.small_height;
    let from_pixel = 2u * (id.y * settings.width + id.x);
    let to_pixel = id.y * settings.small_width + id.x;
    for (var c = 0u; c < CHANNELS; c++) {
        few[to_pixel + c * small_pixels] = full[from_pixel + c * pixels];
    }
}
