// Reconstruction (thesis 6.2.3): what arrives at a pixel is the mean of what arrives at its neighbours, weighed by how much of each
// direction's light the pixel's own surface would reflect over the density that the neighbour has drawn the direction with.

@group(0) @binding(0) var<uniform> window: BounceWindow;
// Octahedral, two snorm16: [directions, height, width].
@group(0) @binding(4) var<storage, read> directions: array<u32>;
// As `pack_radiance` has it: [directions, height, width].
@group(0) @binding(5) var<storage, read> arrived: array<u32>;
// [CHANNELS, height, width]
@group(0) @binding(6) var<storage, read_write> image: array<f32>;

// A neighbour whose normal is turned by 30 degrees counts a third.
const NORMAL_POWER = 8.0;
// Below this a cosine is rounding.
const LEAST_COSINE = 1e-3;

@compute @workgroup_size(TILE, TILE)
fn reconstruct(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= window.width || id.y >= window.height {
        return;
    }
    let pixels = window.width * window.height;
    let centre = id.y * window.width + id.x;
    var mean = vec3f(window.background);
    if surface_valid(centre) {
        let position = surface_position(centre, pixels);
        let normal = surface_normal(centre, pixels);
        var sum = vec4f(0.0);
        let reach = i32(bounded(u32(window.radius), id.xy));
        let count = bounded(window.directions, id.xy);
        for (var y = -reach; y <= reach; y++) {
            for (var x = -reach; x <= reach; x++) {
                let at = vec2i(id.xy) + vec2i(x, y);
                if any(at < vec2i(0)) || at.x >= i32(window.width) || at.y >= i32(window.height) {
                    continue;
                }
                let index = u32(at.y) * window.width + u32(at.x);
                if !surface_valid(index) {
                    continue;
                }
                let other_normal = surface_normal(index, pixels);
                let off_plane = window.sharpness * dot(normal, surface_position(index, pixels) - position);
                let near = exp(-(window.falloff * f32(x * x + y * y) + off_plane * off_plane));
                let alike = near * pow(max(dot(normal, other_normal), 0.0), NORMAL_POWER);
                for (var number = 0u; number < count; number++) {
                    let sample = index + number * pixels;
                    let direction = from_octahedron(unpack2x16snorm(directions[sample]));
                    let drawn = max(dot(other_normal, direction), LEAST_COSINE);
                    let weight = alike * max(dot(normal, direction), LEAST_COSINE) / drawn;
                    sum += weight * vec4f(unpack_radiance(arrived[sample]), 1.0);
                }
            }
        }
        mean = sum.xyz / sum.w;
    }
    for (var c = 0u; c < CHANNELS; c++) {
        image[centre + c * pixels] = mean[c];
    }
}
