// Puts each surfel into its patch: along a sequence that fills it evenly, whatever its length (Roberts 2018, "The Unreasonable
// Effectiveness of Quasirandom Sequences"), so that surfels stay where they are when more are added. The triangle's corners
// are moved inwards by a surfel's radius, so that disks do not stand over its edges (thesis 4.2.1).

@group(0) @binding(0) var<uniform> settings: Surfels;
@group(0) @binding(1) var<storage, read> vertices: array<f32>;
@group(0) @binding(2) var<storage, read> patches: array<Patch>;
@group(0) @binding(3) var<storage, read> amounts: array<f32>;
@group(0) @binding(4) var<storage, read> starts: array<u32>;
@group(0) @binding(5) var<storage, read> totals: Totals;
@group(0) @binding(6) var<storage, read_write> surfels: array<Surfel>;

// One over the plastic number, and over its square.
const STRIDE = vec2f(0.75487767, 0.56984029);

// Where the surfels that are wanted begin of which the one of that index stands for all.
fn share_begin(index: u32) -> u32 {
    let room = LEAF << (2u * HEIGHT);
    let rest = ((totals.wanted % room) << 12u) / room;
    return index * (totals.wanted / room) + ((index * rest) >> 12u);
}

// The surfel of all that are wanted which is the one of that index of those for which there is room: a random one of its
// share, since there may be a pattern in them.
fn chosen(index: u32) -> u32 {
    if totals.wanted <= LEAF << (2u * HEIGHT) {
        return index;
    }
    let begin = share_begin(index);
    let count = share_begin(index + 1u) - begin;
    return begin + u32(random(vec2u(index, 0u), settings.seed, 3u) * f32(count));
}

// The patch of a surfel: the last one that begins no later.
fn patch_of(surfel: u32) -> u32 {
    var low = 0u;
    var high = arrayLength(&starts);
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if starts[middle] <= surfel {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

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
    let offset = vec2f(random(vec2u(index, 0u), settings.seed, 1u), random(vec2u(index, 0u), settings.seed, 2u));
    var at = fract(offset + STRIDE * f32(number + 1u));
    if at.x + at.y > 1.0 {
        at = 1.0 - at;
    }
    let weights = it.weights * vec3f(1.0 - at.x - at.y, at);
    let normal = normalize(cross(it.corners[1] - it.corners[0], it.corners[2] - it.corners[0]));
    let open = select(0u, 1u, part_is_open(patches[index].part));
    let packed_normal = (pack2x16snorm(to_octahedron(normal)) & 0xfffffffeu) | open;
    surfels[id.x] = Surfel(vec4f(inset * weights, radius), packed_normal, 0u, 0u, index);
}
