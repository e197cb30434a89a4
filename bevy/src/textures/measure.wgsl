// By what a frame's light is multiplied: so that 99 % of what is brighter than nothing comes to at most 1.

const BINS = 32768u;
const THREADS = 256u;
const EACH = BINS / THREADS;

// How many numbers of the light there are of each half float, by its bits, which are in the order of size.
@group(0) @binding(0) var<storage, read> counts: array<u32>;
@group(0) @binding(1) var<storage, read_write> exposure: array<f32>;

var<workgroup> sums: array<u32, THREADS>;

@compute @workgroup_size(256)
fn measure(@builtin(local_invocation_index) thread: u32) {
    var sum = 0u;
    for (var i = 0u; i < EACH; i++) { sum += counts[thread * EACH + i]; }
    sums[thread] = sum;
    workgroupBarrier();
    if (thread > 0u) { return; }
    var total = 0u;
    for (var i = 0u; i < THREADS; i++) { total += sums[i]; }
    exposure[0] = 1.0;
    if (total == 0u) { return; }
    // 99 % of the last one's number, without numbers too large for 32 bits.
    let last = total - 1u;
    var left = last / 100u * 99u + last % 100u * 99u / 100u;
    var part = 0u;
    while (left >= sums[part]) { left -= sums[part]; part++; }
    var bits = part * EACH;
    while (left >= counts[bits]) { left -= counts[bits]; bits++; }
    // Devices may take the least half floats for 0.
    exposure[0] = 1.0 / max(unpack2x16float(bits).x, 6e-8);
}
