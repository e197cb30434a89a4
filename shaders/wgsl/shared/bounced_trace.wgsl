// The bounced z-buffer (thesis 6.2 and 6.3), one invocation for each of a pixel's directions: along it, the
// nearest surfel of the finest level that has one. As with splats, level l has one of 4^l surfels, another
// one for each pixel of a square. Rays walk a tree over the surfels. The plain version is
// render/src/methods/bounced_z/reference.rs.

#import shared/bounced_directions
#import shared/bounced_none
#import shared/bounded
#import shared/interleaved
#import shared/packing
#import shared/surface
#import shared/surfel
#import shared/surfel_record
#import shared/surfel_tree
#import shared/surfel_walk
#constant HEIGHT = 8

/// What `methods/bounced_z/trace` reads.
struct Bounces {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Directions of a pixel.
    directions: u32,
    /// Levels of the interleaved framebuffer.
    levels: u32,
    /// Chooses directions, and which pixel meets which surfels.
    seed: u32,
    /// Where the shell of the finest level ends, over a surfel's radius.
    shell: f32,
    /// How much larger than its own is the radius that rays meet.
    cover: f32,
    /// How far the effect reaches, metres.
    reach: f32,
}

@group(0) @binding(0) var<uniform> bounces: Bounces;
@group(0) @binding(4) var<storage, read> totals: Totals;
@group(0) @binding(5) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// Octahedral, two snorm16: [directions, height, width].
@group(0) @binding(7) var<storage, read_write> directions: array<u32>;
// Twice the index of the surfel that is met there, and 1 more where its back is, or NONE: [directions,
// height, width].
@group(0) @binding(8) var<storage, read_write> met: array<u32>;

// Sine of the least angle between the way to a surfel and either surface: the point's own surface does not
// hide it. Surfels' normals are rounded by nearly as much.
const LEAST_SINE = 4.2e-3;

// What a ray has met so far.
struct Hit {
    // That of the shell around the surfel which the ray's origin is in, or NONE.
    level: u32,
    distance: f32,
    surfel: u32,
}

// What the walk asks nodes about.
struct Query {
    origin: vec3f,
    normal: vec3f,
    direction: vec3f,
    // One over the direction's components.
    inverse: vec3f,
    level: u32,
}

// How far the middles of surfels are that are met on a level, if the largest has this radius.
fn outer(level: u32, radius: f32) -> f32 {
    let enlarged = radius * f32(1u << level);
    return select(enlarged * bounces.shell, bounces.reach + enlarged * bounces.cover, level + 1u == bounces.levels);
}

// Whether a ray may meet a surfel below a node: one of its disks reaches beyond its box by its radius.
fn reaches(node: Node, ray: Query) -> bool {
    let gap = max(max(ray.origin - node.high.xyz, node.low.xyz - ray.origin), vec3f(0.0));
    let farthest = outer(ray.level, node.low.w);
    let widened = node.low.w * f32(1u << ray.level) * bounces.cover;
    let a = (node.low.xyz - widened - ray.origin) * ray.inverse;
    let b = (node.high.xyz + widened - ray.origin) * ray.inverse;
    let first = min(a, b);
    let last = max(a, b);
    let enters = max(max(first.x, first.y), max(first.z, 0.0));
    let leaves = min(min(last.x, last.y), min(last.z, bounces.reach));
    // Rounding may not lose what is met at a corner.
    return dot(gap, gap) <= farthest * farthest && enters <= leaves * 1.00001;
}

// Whether one hit is in front of another: the finer level wins, and of a level the nearer.
fn precedes(a: Hit, b: Hit) -> bool {
    if a.level != b.level {
        return a.level < b.level;
    }
    return a.distance < b.distance || (a.distance == b.distance && a.surfel < b.surfel);
}

// Where a ray meets a surfel, as large as the shell wants that its origin is in, but of no coarser level than
// the ray's.
fn hit_of(which: u32, ray: Query) -> Hit {
    let none = Hit(NONE, 0.0, 0u);
    let surfel = surfels[which];
    let way = surfel.place - ray.origin;
    let squared = dot(way, way);
    let own_radius = surfel_radius(surfel);
    let farthest = outer(ray.level, own_radius);
    let normal = surfel_normal(surfel);
    let height = dot(way, normal);
    let least = LEAST_SINE * sqrt(squared);
    let slope = dot(ray.direction, normal);
    if squared >= farthest * farthest || dot(way, ray.normal) <= least || abs(height) <= least || abs(slope) < 1e-6 {
        return none;
    }
    let finest_shell = max(own_radius * bounces.shell, 1e-18);
    let shells_out = ceil(0.5 * log2(squared / (finest_shell * finest_shell)));
    let level = u32(clamp(shells_out, 0.0, f32(ray.level)));
    let radius = own_radius * f32(1u << level) * bounces.cover;
    let distance = height / slope;
    let off = distance * ray.direction - way;
    if distance <= 0.0 || distance >= bounces.reach || dot(off, off) >= radius * radius {
        return none;
    }
    return Hit(level, distance, which);
}

// What a ray meets among the surfels of one level that a pixel has, or what it has met before.
fn nearest(ray: Query, first: u32, before: Hit, pixel: vec2u) -> Hit {
    var hit = before;
    let leaves = bounded(ray.level, pixel);
    var walk = next_leaf(Walk(HEIGHT, 0u), leaves, ray);
    while goes_on(walk) {
        let begin = first_surfel(walk.height, walk.index) + first;
        for (var i = 0u; i < LEAF; i++) {
            let which = begin + (i << (2u * leaves));
            if which >= totals.kept {
                break;
            }
            let other = hit_of(which, ray);
            if precedes(other, hit) {
                hit = other;
            }
        }
        walk = next_leaf(after(walk), leaves, ray);
    }
    return hit;
}

// What the passes after this one read of a hit.
fn met_word(hit: Hit, direction: vec3f) -> u32 {
    if hit.level == NONE {
        return NONE;
    }
    return 2u * hit.surfel + select(0u, 1u, dot(direction, surfel_normal(surfels[hit.surfel])) >= 0.0);
}

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
    let levels = bounded(bounces.levels, pixel);
    var hit = Hit(NONE, 0.0, 0u);
    for (var level = 0u; level < levels; level++) {
        let ray = Query(position, normal, direction, inverse_of(direction), level);
        hit = nearest(ray, number_in_square(pixel, level, bounces.seed), hit, pixel);
    }
    directions[at + id.z * pixels] = pack2x16snorm(to_octahedron(direction));
    met[at + id.z * pixels] = met_word(hit, direction);
}
