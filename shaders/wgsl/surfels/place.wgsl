// Puts each surfel into its patch: along a sequence that fills it evenly, whatever its length (Roberts 2018,
// "The Unreasonable Effectiveness of Quasirandom Sequences"), so that surfels stay where they are when more
// are added. The triangle's corners are moved inwards by a surfel's radius, so that disks do not stand over
// its edges (thesis 4.2.1).

#import shared/random
#import shared/surfel
#import shared/surfel_order
#import shared/surfel_patch
#import shared/surfel_patch_record
#import shared/surfel_record
#import uniforms/surfels

@group(0) @binding(0) var<uniform> settings: Surfels;
@group(0) @binding(1) var<storage, read> vertices: array<f32>;
@group(0) @binding(2) var<storage, read> patches: array<Patch>;
@group(0) @binding(3) var<storage, read> amounts: array<f32>;
@group(0) @binding(4) var<storage, read> starts: array<u32>;
@group(0) @binding(5) var<storage, read> totals: Totals;
@group(0) @binding(6) var<storage, read_write> surfels: array<Surfel>;

// One over the plastic number, and over its square.
const STRIDE = vec2f(0.75487767, 0.56984029);

// A triangle's corner, moved towards its middle.
fn inwards(corner: vec3f, middle: vec3f, by: f32) -> vec3f {
    let way = middle - corner;
    return corner + way * min(1.0, by / max(length(way), 1e-30));
}

@compute @workgroup_size(64)
fn place(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let wanted = chosen(id.x);
    let index = patch_of(wanted);
    let number = wanted - starts[index];
    let it = laid(patches[index]);
    let share = clamp(amounts[index] - f32(number), 0.0, 1.0) * part_coverage(patches[index].part);
    let spread = f32(totals.wanted) / f32(totals.kept);
    let radius = it.radius * sqrt(share * spread);

    let middle = (it.corners[0] + it.corners[1] + it.corners[2]) / 3.0;
    let inset = mat3x3f(
        inwards(it.corners[0], middle, it.radius),
        inwards(it.corners[1], middle, it.radius),
        inwards(it.corners[2], middle, it.radius),
    );
    let offset = vec2f(random(vec2u(index, 0u), 0u, 1u), random(vec2u(index, 0u), 0u, 2u));
    var at = fract(offset + STRIDE * f32(number + 1u));
    if at.x + at.y > 1.0 {
        at = 1.0 - at;
    }
    let weights = it.weights * vec3f(1.0 - at.x - at.y, at);
    let normal = normalize(cross(it.corners[1] - it.corners[0], it.corners[2] - it.corners[0]));
    let bits = bits_of_radius(radius, random(vec2u(index, number), 0u, 4u));
    surfels[id.x] = new_surfel(inset * weights, normal, part_is_open(patches[index].part), bits);
}
