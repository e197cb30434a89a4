// Two images of one effect on the screen, one to the left of a border and one to the right, in the colours of
// a screen.

/// What `frame/wipe` reads.
struct Wipe {
    /// Columns of the images.
    width: u32,
    /// Rows of the images.
    height: u32,
    /// Their channels: 1 or 3.
    channels: u32,
    /// Columns to the left of the border.
    border: f32,
    /// What light is multiplied by.
    scale: f32,
    /// How much brightness is compressed.
    compression: f32,
    /// How much of that is taken back.
    stretch: f32,
}

@group(0) @binding(0) var<storage, read> left: array<f32>;
@group(0) @binding(1) var<storage, read> right: array<f32>;
@group(0) @binding(2) var<uniform> wipe: Wipe;

// A triangle that covers the screen.
@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    return vec4f(vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4f) -> @location(0) vec4f {
    let pixel = min(u32(at.y), wipe.height - 1u) * wipe.width + min(u32(at.x), wipe.width - 1u);
    let plane = select(0u, wipe.height * wipe.width, wipe.channels > 1u);
    let place = vec3u(pixel, pixel + plane, pixel + 2u * plane);
    var linear = vec3f(left[place.x], left[place.y], left[place.z]);
    if at.x >= wipe.border {
        linear = vec3f(right[place.x], right[place.y], right[place.z]);
    }
    let bright = wipe.scale * dot(linear, vec3f(0.2126, 0.7152, 0.0722));
    let shown = linear * wipe.scale * (1.0 + bright * wipe.stretch) / (1.0 + bright * wipe.compression);
    let inside = clamp(shown, vec3f(0.0), vec3f(1.0));
    // IEC 61966-2-1.
    let encoded = select(1.055 * pow(inside, vec3f(1.0 / 2.4)) - 0.055, 12.92 * inside, inside <= vec3f(0.0031308));
    return vec4f(encoded, 1.0);
}
