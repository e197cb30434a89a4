// Turns sums into where each begins, and says how many there are in all.

#import shared/surfel
#constant HEIGHT = 8

@group(0) @binding(0) var<storage, read_write> sums: array<u32>;
@group(0) @binding(1) var<storage, read_write> totals: Totals;

@compute @workgroup_size(1)
fn total() {
    var before = 0u;
    for (var i = 0u; i < arrayLength(&sums); i++) {
        let sum = sums[i];
        sums[i] = before;
        before += sum;
    }
    totals.wanted = before;
    totals.kept = min(before, LEAF << (2u * HEIGHT));
    totals.surfel_groups[0] = (totals.kept + 63u) / 64u;
    totals.surfel_groups[1] = 1u;
    totals.surfel_groups[2] = 1u;
    totals.leaf_groups[0] = (totals.kept + 64u * LEAF - 1u) / (64u * LEAF);
    totals.leaf_groups[1] = 1u;
    totals.leaf_groups[2] = 1u;
}
