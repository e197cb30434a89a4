// Reconstruction (thesis 6.2.3): what a pixel's surface makes of what arrives at it and at its neighbours,
// each weighed by the density that the pixel would have drawn its direction with over that which the
// neighbour has drawn it with.

#import shared/bounded
#import shared/packing
#import shared/surface

/// What `methods/bounced_z/filter` reads.
struct BounceWindow {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Directions of a pixel.
    directions: u32,
    /// Pixels on every side that are filtered together.
    radius: i32,
    /// The Gaussian's exponent of a distance of one pixel.
    falloff: f32,
    /// Factor, one over metres, of a distance from the tangent plane before it is squared into the exponent.
    sharpness: f32,
    /// What is where no surface is seen.
    background: f32,
}

@group(0) @binding(0) var<uniform> window: BounceWindow;
// Octahedral, two snorm16: [directions, height, width].
@group(0) @binding(4) var<storage, read> directions: array<u32>;
// As `pack_radiance` has it: [directions, height, width].
@group(0) @binding(5) var<storage, read> arrived: array<u32>;
// [CHANNELS, height, width]
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

// A neighbour whose normal is turned by 30 degrees counts a third.
const NORMAL_POWER = 8.0;

@compute @workgroup_size(TILE, TILE)
fn reconstruct(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= window.width || id.y >= window.height {
        return;
    }
    let pixels = window.width * window.height;
    let centre = id.y * window.width + id.x;
    var mean = vec3f(window.background);
    let reflector = reflector_at(centre, pixels);
    if surface_valid(centre) && reflects(reflector) {
        let position = surface_position(centre, pixels);
        let normal = surface_normal(centre, pixels);
        var sum = vec3f(0.0);
        var weights = 0.0;
        let reach = i32(bounded(u32(window.radius), id.xy));
        let count = bounded(window.directions, id.xy);
        for (var y = -reach; y <= reach; y++) {
            for (var x = -reach; x <= reach; x++) {
                let at = vec2i(id.xy) + vec2i(x, y);
                if any(at < vec2i(0)) || at.x >= i32(window.width) || at.y >= i32(window.height) {
                    continue;
                }
                let index = u32(at.y) * window.width + u32(at.x);
                let other = reflector_at(index, pixels);
                if !surface_valid(index) || !reflects(other) {
                    continue;
                }
                let other_normal = surface_normal(index, pixels);
                let off_plane = window.sharpness * dot(normal, surface_position(index, pixels) - position);
                let near = exp(-(window.falloff * f32(x * x + y * y) + off_plane * off_plane));
                let alike = near * pow(max(dot(normal, other_normal), 0.0), NORMAL_POWER);
                for (var number = 0u; number < count; number++) {
                    let sample = index + number * pixels;
                    let direction = from_octahedron(unpack2x16snorm(directions[sample]));
                    let weight = alike * density_of(reflector, direction) / density_of(other, direction);
                    sum += weight * weight_of(reflector, direction) * unpack_radiance(arrived[sample]);
                    weights += weight;
                }
            }
        }
        mean = sum / weights;
    }
    for (var c = 0u; c < CHANNELS; c++) {
        image[centre + c * pixels] = mean[c];
    }
}
