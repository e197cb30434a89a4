// How surfaces move in the image while the shutter is open.

#import uniforms/reconstruction

@group(0) @binding(0) var<uniform> settings: Reconstruction;
// Planes [2, height, width]: direction, from x to the right towards y up, and length in pixels.
@group(0) @binding(3) var<storage, read> motion_planes: array<f32>;

// Half of the movement of what is seen at a pixel, pixels, y down, and its length: it is seen in the middle
// of the exposure.
fn half_movement(index: u32) -> vec3f {
    let pixels = settings.width * settings.height;
    let direction = motion_planes[index];
    let reach = min(0.5 * motion_planes[index + pixels], settings.longest);
    return reach * vec3f(cos(direction), -sin(direction), 1.0);
}
