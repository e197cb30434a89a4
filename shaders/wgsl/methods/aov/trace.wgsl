// The bounced z-buffer over facets (thesis 6.2), one invocation for each of a pixel's directions: whether a
// facet within reach hides the sky there. Of the nearest it matters only that there is one, so that the first
// that is met ends the walk. As with what facets occlude, one slice of them comes after the other.

#import shared/bounced_directions
#import shared/bounced_matte
#import shared/facet
#import shared/inverse_direction
#import shared/packing
#import shared/random
#import shared/surface
#import shared/surface_valid
#import shared/surfel
#import shared/surfel_patch_record
#import shared/surfel_tree
#import shared/surfel_walk
#import uniforms/facet_slice
#constant HEIGHT = 10
#constant SLICE = 4

/// What `methods/aov/trace` reads.
struct FacetRays {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Directions of a pixel.
    directions: u32,
    /// Chooses directions.
    seed: u32,
    /// How far the effect reaches, metres.
    reach: f32,
}

@group(0) @binding(0) var<uniform> rays: FacetRays;
@group(0) @binding(4) var<uniform> slice: FacetSlice;
@group(0) @binding(5) var<storage, read> facets: array<Facet>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// Octahedral, two snorm16: [directions, height, width].
@group(0) @binding(7) var<storage, read_write> directions: array<u32>;
// What arrives from there past the slices so far, as `pack_radiance` has it: [directions, height, width].
@group(0) @binding(8) var<storage, read_write> arrived: array<u32>;

// The facets up to the end of the slice, as if there were no others.
var<private> totals: Totals;

// What the walk asks nodes about.
struct Query {
    origin: vec3f,
    direction: vec3f,
    // One over the direction's components.
    inverse: vec3f,
}

// Whether a ray may meet a facet below a node.
fn reaches(node: Node, ray: Query) -> bool {
    let a = (node.low.xyz - ray.origin) * ray.inverse;
    let b = (node.high.xyz - ray.origin) * ray.inverse;
    let first = min(a, b);
    let last = max(a, b);
    let enters = max(max(first.x, first.y), max(first.z, 0.0));
    let leaves = min(min(last.x, last.y), min(last.z, rays.reach));
    // Rounding may not lose what is met at a corner, nor a box without depth.
    return enters <= leaves * 1.00001 + 1e-6 * rays.reach;
}

// Whether a ray meets a facet within reach (Moeller and Trumbore 1997), from either side.
fn meets(facet: Facet, ray: Query) -> bool {
    let a = point(facet.a);
    let first = point(facet.b) - a;
    let second = point(facet.c) - a;
    let across = cross(ray.direction, second);
    let size = dot(first, across);
    let way = ray.origin - a;
    let u = dot(way, across) / size;
    let upwards = cross(way, first);
    let v = dot(ray.direction, upwards) / size;
    let distance = dot(second, upwards) / size;
    return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0 && distance < rays.reach;
}

// Whether a ray meets a part of a facet that is there: of one that is half transparent half of the rays do.
fn is_hidden(ray: Query, pixel: vec2u, number: u32) -> bool {
    var walk = next_leaf(Walk(SLICE, slice.index), 0u, ray);
    while goes_on(walk) {
        let begin = first_surfel(0u, walk.index);
        for (var i = begin; i < min(begin + LEAF, totals.kept); i++) {
            let facet = facets[i];
            if meets(facet, ray) && random(pixel, hash(rays.seed + i), number) < part_coverage(facet.part) {
                return true;
            }
        }
        walk = next_leaf(after(walk), 0u, ray);
    }
    return false;
}

@compute @workgroup_size(TILE, TILE)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= rays.width || id.y >= rays.height {
        return;
    }
    let pixel = id.xy;
    let pixels = rays.width * rays.height;
    let at = pixel.y * rays.width + pixel.x;
    let sample = at + id.z * pixels;
    let hidden_before = slice.index > 0u && arrived[sample] == pack_radiance(vec3f(0.0));
    if !surface_valid(at) || hidden_before {
        return;
    }
    let normal = surface_normal(at, pixels);
    let origin = lifted(surface_position(at, pixels), normal, rays.reach);
    let direction = direction_of(Reflector(normal), place_on_disk(pixel, id.z, vec2u(rays.directions, rays.seed)));
    totals.kept = min(arrayLength(&facets), first_surfel(SLICE, slice.index + 1u));
    let hidden = is_hidden(Query(origin, direction, inverse_of(direction)), pixel, id.z);
    directions[sample] = pack2x16snorm(to_octahedron(direction));
    arrived[sample] = pack_radiance(vec3f(select(1.0, 0.0, hidden)));
}
