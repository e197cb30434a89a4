// How many surfels each patch gets: its area over that of a surfel, where it may matter to what is seen. The
// last surfel of a patch stands for what remains and grows from nothing as the camera comes closer; of
// patches smaller than a surfel one in so many has one, which grows too. So nothing pops up, and the mean of
// the surfels' area is the patches'. The paper's two passes, fine surfels and discarding (thesis 4.2.1), in
// one.

#import shared/surfel
#import shared/surfel_patch
#import shared/surfel_patch_record
#import uniforms/surfels
#constant HEIGHT = 8

@group(0) @binding(0) var<uniform> settings: Surfels;
@group(0) @binding(1) var<storage, read> vertices: array<f32>;
@group(0) @binding(2) var<storage, read> patches: array<Patch>;
@group(0) @binding(3) var<storage, read_write> amounts: array<f32>;
@group(0) @binding(4) var<storage, read_write> counts: array<u32>;

// The share of a surfel that a patch of `share` of one gets, at a threshold from 0 to 1: 0 below it, rising
// above it, and 1 for all thresholds where the share is 1. Its mean over all thresholds is the share.
fn roulette(share: f32, threshold: f32) -> f32 {
    let chance = (1.0 + RISE) * share;
    let above = chance / max(threshold, 1e-9);
    let size = LARGEST * clamp((above - 1.0) / RISE, 0.0, 1.0);
    var mean = 1.0;
    if chance > 1.0 {
        let risen = 1.0 + RISE;
        mean = LARGEST * ((log(risen / chance) + 1.0 / risen - 1.0 / chance) / RISE + 1.0 / risen);
    }
    return share * size / (chance * mean);
}

// Steps of the golden ratio: of patches that follow one another, and so lie together, always about the same
// share has a surfel.
fn threshold(index: u32) -> f32 {
    return f32((index * 2654435769u) >> 8u) * 0x1p-24;
}

// Whether what is this near to a point may be seen.
fn matters(middle: vec3f, reach: f32) -> bool {
    return -middle.z > -reach && outside(middle) < reach;
}

@compute @workgroup_size(64)
fn measure(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index >= arrayLength(&patches) {
        return;
    }
    let it = laid(patches[index]);
    let weights = it.weights;
    let middle = it.corners * ((weights[0] + weights[1] + weights[2]) / 3.0);
    let extent = max(
        length(it.corners * weights[0] - middle),
        max(length(it.corners * weights[1] - middle), length(it.corners * weights[2] - middle))
    );
    let share = it.area / (PI * it.radius * it.radius);
    var amount = 0.0;
    // Not what is no number either.
    if share > 0.0 && share < 2.0 * MOST && matters(middle, extent + settings.reach) {
        amount = share;
        if share < 1.0 {
            amount = roulette(share, threshold(index));
        }
    }
    amounts[index] = amount;
    counts[index] = u32(ceil(amount));
}
