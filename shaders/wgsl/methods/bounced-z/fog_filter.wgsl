// What neighbouring pixels' rays say of the light that a medium scatters to a pixel: of those that start on
// the part of the view ray that this pixel sees, each weighed by the density with which the pixel would have
// drawn its place over that with which the neighbour has.

#import shared/bounded
#import shared/packing
#import uniforms/medium_record

/// What `methods/bounced_z/fog_filter` reads.
struct FogWindow {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Rays of a pixel.
    directions: u32,
    /// Pixels on every side that are filtered together.
    radius: i32,
    /// By how much weights' roots fall over a distance of one pixel.
    falloff: f32,
}

@group(0) @binding(0) var<uniform> window: FogWindow;
@group(0) @binding(1) var<uniform> medium: MediumRecord;
// [height, width, 4]: `shared/intervals`.
@group(0) @binding(2) var<storage, read> rays: array<vec4f>;
// [directions, height, width]: `methods/bounced-z/fog_trace`.
@group(0) @binding(3) var<storage, read> arrived: array<vec2u>;
// [3, height, width]
@group(0) @binding(4) var<storage, read_write> image: array<f32>;

// How much of the mean transmittance a pixel's ray loses.
fn loss(at: u32) -> f32 {
    return 1.0 - exp(-dot(medium.extinction.rgb, vec3f(1.0 / 3.0)) * rays[at].z);
}

@compute @workgroup_size(TILE, TILE)
fn gather(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= window.width || id.y >= window.height {
        return;
    }
    let pixels = window.width * window.height;
    let centre = id.y * window.width + id.x;
    let seen = rays[centre].xy;
    var sum = vec3f(0.0);
    var weights = 0.0;
    let reach = i32(bounded(u32(window.radius), id.xy));
    let count = bounded(window.directions, id.xy);
    for (var y = -reach; y <= reach; y++) {
        for (var x = -reach; x <= reach; x++) {
            let at = vec2i(id.xy) + vec2i(x, y);
            let near = 1.0 - window.falloff * f32(x * x + y * y);
            let is_outside = any(at < vec2i(0)) || at.x >= i32(window.width) || at.y >= i32(window.height);
            if is_outside || near <= 0.0 {
                continue;
            }
            let index = u32(at.y) * window.width + u32(at.x);
            // Densities are one over it, but for what is the same for all pixels.
            let weight = near * near * loss(index);
            for (var number = 0u; number < count; number++) {
                let sample = arrived[index + number * pixels];
                let distance = bitcast<f32>(sample.x);
                if distance >= seen.x && distance <= seen.y {
                    sum += weight * unpack_radiance(sample.y);
                    weights += weight;
                }
            }
        }
    }
    let light = loss(centre) * sum / max(weights, 1e-30);
    for (var c = 0u; c < 3u; c++) {
        image[centre + c * pixels] = light[c];
    }
}
