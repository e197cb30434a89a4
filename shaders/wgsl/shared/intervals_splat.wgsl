// Shell splatting onto the intervals of rays (Nalbach, Ritschel and Seidel 2014, 4.2), of one level, turned
// round as in methods/surfel/splat: each pixel of a sub-buffer adds up what the surfels scatter to it that
// this sub-buffer gets. The plain version is render/src/methods/volume_shell/reference.rs.

#import shared/bounded
#import shared/interleaved
#import shared/intervals_decode
#import shared/medium
#import shared/phase
#import shared/surfel
#import shared/surfel_facing
#import shared/surfel_record
#import shared/surfel_sent
#import shared/surfel_tree
#import shared/surfel_walk
#import shared/transmittance
#import shared/view
#import uniforms/frame_view
#import uniforms/medium_record
#import uniforms/splat_level
#import uniforms/volume_shell
#constant ATTENUATED = 1
#constant LOOKUPS = 4
#constant PARTS = 16
#constant SAMPLES = 16
#constant SILHOUETTES = 1
#constant TOUCHED_ONLY = 1

/// The leaves of one run of `methods/volume_shell/splat`.
struct SplatPart {
    /// Which part of them.
    index: u32,
}

@group(0) @binding(0) var<uniform> level: SplatLevel;
@group(0) @binding(1) var<uniform> volume: VolumeShell;
@group(0) @binding(2) var<uniform> view: FrameView;
@group(0) @binding(3) var<uniform> medium: MediumRecord;
@group(0) @binding(4) var<storage, read> totals: Totals;
@group(0) @binding(5) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// [height, width, 4]: light, and how much the ray scatters.
@group(0) @binding(7) var<storage, read_write> sums: array<vec4f>;
@group(0) @binding(9) var<storage, read> rays: array<vec4f>;
@group(0) @binding(10) var<storage, read> samples: array<array<u32, SAMPLES / 2u>>;
@group(0) @binding(11) var densities: texture_3d<f32>;
// Which part of the tree's leaves: what all do to a pixel may take more turns of loops than a software device
// allows.
@group(0) @binding(12) var<uniform> part: SplatPart;

// A pixel's ray, camera space.
struct Query {
    direction: vec3f,
    enters: f32,
    leaves: f32,
}

// Where a ray is in the shell around a surfel.
struct Shell {
    // The surfel's distance along the ray, and its shell's reach from there.
    along: f32,
    half: f32,
    // The same of the hole in its middle; negative where the ray misses it.
    hole: f32,
}

fn outer(radius: f32) -> f32 {
    return select(min(level.reach, radius * level.farthest), level.reach, level.last == 1u);
}

// Whether a surfel below a node may do something to a part of the ray: by the sphere around its box.
fn reaches(node: Node, ray: Query) -> bool {
    let middle = 0.5 * (node.low.xyz + node.high.xyz);
    let along = clamp(dot(middle, ray.direction), ray.enters, ray.leaves);
    let reach = outer(node.low.w) + 0.5 * distance(node.low.xyz, node.high.xyz);
    let way = middle - along * ray.direction;
    return node.low.w > 0.0 && dot(way, way) <= reach * reach;
}

// Half of the length that a sphere has of a line at a squared distance from its middle; negative where it has
// none.
fn half_chord(radius: f32, aside: f32) -> f32 {
    let rest = radius * radius - aside;
    return select(-1.0, sqrt(max(rest, 0.0)), rest > 0.0);
}

fn shell_around(which: u32, ray: Query) -> Shell {
    let place = surfels[which].place;
    let radius = surfel_radius(surfels[which]);
    let along = dot(place, ray.direction);
    let off = place - along * ray.direction;
    let aside = dot(off, off);
    return Shell(along, half_chord(outer(radius), aside), half_chord(radius * level.nearest, aside));
}

// The first point of the ray that is no nearer than this.
fn first_beyond(distance: f32) -> u32 {
    var low = 0u;
    var high = INTERVALS;
    while low < high {
        let middle = (low + high) / 2u;
        if points[middle] < distance {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// What of light from a surfel arrives at a point of the ray.
fn arriving_share(way: vec3f, distance: f32, point: vec3f) -> vec3f {
    if ATTENUATED == 0u {
        return vec3f(1.0);
    }
    let origin = view.eye.xyz + from_view(point, view);
    return share_of_colours(passed_density(origin, from_view(way / distance, view), distance, LOOKUPS));
}

// What a surfel scatters at a point of the ray towards the eye, of all that is scattered there.
fn scattered_at(which: u32, point: vec3f, ray: Query) -> vec3f {
    let way = surfels[which].place - point;
    let squared = dot(way, way);
    let radius = surfel_radius(surfels[which]);
    let inner = radius * level.nearest;
    let farthest = outer(radius);
    let facing = surfel_facing(surfels[which], way);
    if squared < inner * inner || squared >= farthest * farthest || facing <= 0.0 {
        return vec3f(0.0);
    }
    let distance = sqrt(squared);
    let bounded_square = max(squared, volume.nearest * volume.nearest);
    let solid_angle = PI * radius * radius * facing / (distance * (bounded_square + radius * radius));
    let cosine = dot(way, ray.direction) / distance;
    return surfel_sent(which, way) * arriving_share(way, distance, point) * (solid_angle * phase(cosine));
}

// Light of the intervals of a ray that are in the shell around a surfel.
fn scattered_by(which: u32, ray: Query) -> vec3f {
    let shell = shell_around(which, ray);
    var sum = vec3f(0.0);
    if shell.half < 0.0 {
        return sum;
    }
    var next = 0u;
    var end = INTERVALS;
    if TOUCHED_ONLY == 1u {
        next = first_beyond(shell.along - shell.half);
        end = first_beyond(shell.along + shell.half);
    }
    while next < end {
        if TOUCHED_ONLY == 1u && abs(points[next] - shell.along) < shell.hole {
            next = max(first_beyond(shell.along + shell.hole), next + 1u);
        } else {
            sum += weights[next] * scattered_at(which, points[next] * ray.direction, ray);
            next++;
        }
    }
    return sum;
}

// Light that the surfels of a leaf scatter which a sub-buffer gets.
fn scattered_by_leaf(walk: Walk, leaves: u32, sub_buffer: u32, ray: Query) -> vec3f {
    let first = first_surfel(walk.height, walk.index) + sub_buffer;
    var sum = vec3f(0.0);
    for (var i = 0u; i < LEAF; i++) {
        let which = first + (i << (2u * leaves));
        if which >= totals.kept {
            break;
        }
        sum += scattered_by(which, ray);
    }
    return sum;
}

@compute @workgroup_size(TILE, TILE)
fn splat(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let sub_buffer = group.z;
    let pixel = interleaved_pixel(sub_buffer, group.xy * TILE + local.xy, level.level, level.seed);
    if any(pixel >= vec2u(level.width, level.height)) {
        return;
    }
    let at = pixel.y * level.width + pixel.x;
    let record = rays[at];
    let direction = normalize(view_position(vec2f(pixel) + 0.5, 1.0, view));
    let ray = Query(direction, record.x, record.y);
    read_intervals(samples[at], record, volume.steps);
    var sum = vec3f(0.0);
    if record.y > record.x && record.z > 0.0 {
        let leaves = bounded(level.level, pixel);
        let count = totals.kept / first_surfel(leaves, 1u) + 1u;
        let end = first_surfel(leaves, (part.index + 1u) * count / PARTS);
        var walk = next_leaf(Walk(leaves, part.index * count / PARTS), leaves, ray);
        while goes_on(walk) && first_surfel(walk.height, walk.index) < end {
            sum += scattered_by_leaf(walk, leaves, sub_buffer, ray);
            walk = next_leaf(after(walk), leaves, ray);
        }
    }
    // What is blurred is light over how much the ray scatters, or light alone.
    let scatters = select(1.0, 1.0 - mean_transmittance(record.z), SILHOUETTES == 1u);
    let before = select(sums[at].rgb, vec3f(0.0), part.index == 0u);
    sums[at] = vec4f(before + level.stands_for * sum, scatters);
}
