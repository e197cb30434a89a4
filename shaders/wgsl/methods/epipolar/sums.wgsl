// Partial sums over light rays, of all sweeps at once. The tree of Baran et al. 2010 (section 5) is changed
// light ray by light ray while a sweep goes over view rays; here every node, 4 to 64 light rays, keeps its
// light rays in the order in which they end, and behind each the sum of those that end later: what the node
// holds whenever a view ray asks. Two children are merged by looking each element up in the other child,
// whose sum there is added to its own.
//
// What is summed is 1, the place and its square, with which a node gives the sum of a quadratic function.
// Places are odd numbers of half light rays from the beginning of 64, so that sums are whole numbers of 13
// and 19 bits.

#import uniforms/epipolar

@group(0) @binding(0) var<uniform> epipolar: Epipolar;
// [lines of a part, light rays]
@group(0) @binding(1) var<storage, read> ends: array<f32>;
// [5, lines of a part, light rays, 2]: ends in order by nodes of 4, 8, 16, 32 and 64, and sums from each on,
// places in the upper 13 bits.
@group(0) @binding(2) var<storage, read_write> sums: array<vec2u>;

const LEAVES = 64u;
const LEVELS = 6u;
const SQUARES = 19u;

var<workgroup> keys: array<array<f32, LEAVES>, 2>;
var<workgroup> behind: array<array<u32, LEAVES>, 2>;

// How many keys of a node of the level below are less, or no larger where those that are equal come first.
fn less_than(key: f32, side: u32, first: u32, size: u32, equal_first: bool) -> u32 {
    var low = 0u;
    for (var step = size; step > 0u; step /= 2u) {
        let at = low + step - 1u;
        if low + step <= size && (keys[side][first + at] < key || (equal_first && keys[side][first + at] == key)) {
            low += step;
        }
    }
    return low;
}

@compute @workgroup_size(LEAVES)
fn sum_up(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) leaf: u32) {
    let first_ray = group.y * epipolar.light_rays + group.x * LEAVES;
    keys[0][leaf] = ends[first_ray + leaf];
    let place = 2u * leaf + 1u;
    behind[0][leaf] = (place << SQUARES) | (place * place);
    workgroupBarrier();
    for (var level = 1u; level <= LEVELS; level++) {
        let side = (level + 1u) % 2u;
        let size = 1u << (level - 1u);
        let own = leaf / size * size;
        let other = own ^ size;
        let key = keys[side][leaf];
        // Of equal keys those of the first child come first.
        let passed = less_than(key, side, other, size, other < own);
        let to = min(own, other) + (leaf - own) + passed;
        var sum = behind[side][leaf];
        if passed < size {
            sum += behind[side][other + passed];
        }
        keys[1u - side][to] = key;
        behind[1u - side][to] = sum;
        workgroupBarrier();
        if level >= 2u {
            let at = (level - 2u) * epipolar.lines * epipolar.light_rays + first_ray + leaf;
            sums[at] = vec2u(bitcast<u32>(keys[1u - side][leaf]), behind[1u - side][leaf]);
        }
        workgroupBarrier();
    }
}
