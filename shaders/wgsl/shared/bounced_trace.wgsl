// The bounced z-buffer (thesis 6.2), one invocation for each of a pixel's directions: the nearest surfel
// along it. The plain version is render/src/methods/bounced_z/reference.rs.

#import shared/bounced_directions
#import shared/packing
#import shared/surface
#import shared/surfel_nearest

@group(0) @binding(0) var<uniform> bounces: Bounces;
@group(0) @binding(4) var<storage, read> totals: Totals;
@group(0) @binding(5) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// Octahedral, two snorm16: [directions, height, width].
@group(0) @binding(7) var<storage, read_write> directions: array<u32>;
// Twice the index of the surfel that is met there, and 1 more where its back is, or NONE: [directions,
// height, width].
@group(0) @binding(8) var<storage, read_write> met: array<u32>;

@compute @workgroup_size(TILE, TILE)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= bounces.width || id.y >= bounces.height {
        return;
    }
    let pixel = id.xy;
    let pixels = bounces.width * bounces.height;
    let at = pixel.y * bounces.width + pixel.x;
    let reflector = reflector_at(at, pixels);
    if !surface_valid(at) || !reflects(reflector) {
        met[at + id.z * pixels] = NONE;
        return;
    }
    let position = surface_position(at, pixels);
    let normal = surface_normal(at, pixels);
    let direction = direction_of(reflector, place_on_disk(pixel, id.z, vec2u(bounces.directions, bounces.seed)));
    let hit = nearest(Ray(position, normal, direction));
    directions[at + id.z * pixels] = pack2x16snorm(to_octahedron(direction));
    met[at + id.z * pixels] = met_word(hit, direction);
}
