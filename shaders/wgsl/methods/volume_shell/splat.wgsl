// Shell splatting onto the intervals of rays (Nalbach, Ritschel and Seidel 2014, 4.2), of one level, turned round as in
// methods/surfel/splat: each pixel of a sub-buffer adds up what the surfels scatter to it that this sub-buffer gets. The plain
// version is render/src/methods/volume_shell/reference.rs.

@group(0) @binding(0) var<uniform> level: SplatLevel;
@group(0) @binding(1) var<uniform> volume: VolumeShell;
@group(0) @binding(2) var<uniform> view: FrameView;
@group(0) @binding(3) var<uniform> medium: MediumRecord;
@group(0) @binding(4) var<storage, read> totals: Totals;
@group(0) @binding(5) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(6) var<storage, read> nodes: array<Node>;
// [height, width, 4]: light, and how much of what falls on the ray from behind is scattered or absorbed.
@group(0) @binding(7) var<storage, read_write> sums: array<vec4f>;
@group(0) @binding(9) var<storage, read> rays: array<vec4f>;
@group(0) @binding(10) var<storage, read> distances: array<array<u32, SAMPLES / 2u>>;
@group(0) @binding(11) var densities: texture_3d<f32>;

// A pixel's ray, camera space.
struct Query {
    direction: vec3f,
    enters: f32,
    leaves: f32,
}

fn outer(distance: f32) -> f32 {
    return select(min(level.reach, distance * level.farthest), level.reach, level.last == 1u);
}

// Whether a surfel below a node may do something to a part of the ray: by the sphere around its box.
fn reaches(node: Node, ray: Query) -> bool {
    let middle = 0.5 * (node.low.xyz + node.high.xyz);
    let along = clamp(dot(middle, ray.direction), ray.enters, ray.leaves);
    let reach = outer(node.low.w) + 0.5 * distance(node.low.xyz, node.high.xyz);
    let way = middle - along * ray.direction;
    return node.low.w > 0.0 && dot(way, way) <= reach * reach;
}

fn sample_distance(words: array<u32, SAMPLES / 2u>, index: u32, ray: Query) -> f32 {
    var all = words;
    let share = f32((all[index / 2u] >> (16u * (index % 2u))) & 65535u) / 65535.0;
    return mix(ray.enters, ray.leaves, share);
}

// What of light from a surfel arrives at a point of the ray.
fn arriving_share(way: vec3f, distance: f32, point: vec3f) -> vec3f {
    if volume.attenuated == 0u {
        return vec3f(1.0);
    }
    let origin = view.eye.xyz + from_view(point, view);
    let passed = passed_density(origin, from_view(way / distance, view), distance, volume.points);
    return exp(-medium.extinction.rgb * passed);
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
fn scattered_by(which: u32, ends: array<f32, SAMPLES>, weights: array<vec3f, SAMPLES>, ray: Query) -> vec3f {
    var all = ends;
    var shares = weights;
    let along = dot(surfels[which].place, ray.direction);
    let aside = surfels[which].place - along * ray.direction;
    let farthest = outer(surfel_radius(surfels[which]));
    let rest = farthest * farthest - dot(aside, aside);
    var sum = vec3f(0.0);
    if rest <= 0.0 {
        return sum;
    }
    let half = sqrt(rest);
    for (var i = 0u; i + 1u < SAMPLES; i++) {
        let middle = 0.5 * (all[i] + all[i + 1u]);
        if volume.culled == 1u && abs(middle - along) > half {
            continue;
        }
        sum += shares[i] * scattered_at(which, middle * ray.direction, ray);
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
    let ray = Query(normalize(view_position(vec2f(pixel) + 0.5, 1.0, view)), record.x, record.y);
    // Where samples are, and what of the light that is scattered in the interval behind each arrives at the eye.
    var ends: array<f32, SAMPLES>;
    var weights: array<vec3f, SAMPLES>;
    for (var i = 0u; i < SAMPLES; i++) {
        ends[i] = sample_distance(distances[at], i, ray);
    }
    let extinction = medium.extinction.rgb;
    let albedo = medium.scattering.rgb / max(extinction, vec3f(1e-30));
    var before = vec3f(1.0);
    for (var i = 0u; i + 1u < SAMPLES; i++) {
        let after = exp(-extinction * passed_before(i + 1u, record.z, record.w));
        weights[i] = albedo * max(before - after, vec3f(0.0));
        before = after;
    }
    var sum = vec3f(0.0);
    if record.y > record.x && record.z > 0.0 {
        let leaves = bounded(level.level, pixel);
        var walk = next_leaf(Walk(HEIGHT, 0u), leaves, ray);
        while goes_on(walk) {
            let first = first_surfel(walk.height, walk.index) + sub_buffer;
            for (var i = 0u; i < LEAF; i++) {
                let which = first + (i << (2u * leaves));
                if which >= totals.kept {
                    break;
                }
                sum += scattered_by(which, ends, weights, ray);
            }
            walk = next_leaf(after(walk), leaves, ray);
        }
    }
    sums[at] = vec4f(level.stands_for * sum, 1.0 - mean_transmittance(record.z));
}
