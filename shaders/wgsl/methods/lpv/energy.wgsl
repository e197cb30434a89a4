// Energy of each kind of light on its way, of 64 parts of the cells: render/src/lpv/series.rs.

#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lobe
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [kinds, 3, cells]: lobes
@group(0) @binding(1) var<storage, read> state: array<vec4f>;
// [64, kinds]: energy of red, green and blue
@group(0) @binding(2) var<storage, read_write> energies: array<vec4f>;

const PARTS = 64u;
const THREADS = 64u;

var<workgroup> sums: array<vec3f, THREADS>;

@compute @workgroup_size(64)
fn measure(
    @builtin(workgroup_id) part: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    for (var light = 0u; light < KINDS; light++) {
        var sum = vec3f(0.0);
        for (var cell = THREADS * part.x + thread; cell < cell_count(); cell += PARTS * THREADS) {
            for (var c = 0u; c < 3u; c++) {
                sum[c] += moments(state[lobe_index(light, c, cell)]).w;
            }
        }
        sums[thread] = sum;
        workgroupBarrier();
        for (var half = THREADS / 2u; half > 0u; half /= 2u) {
            if thread < half {
                sums[thread] += sums[thread + half];
            }
            workgroupBarrier();
        }
        if thread == 0u {
            energies[KINDS * part.x + light] = vec4f(sums[0], 0.0);
        }
        workgroupBarrier();
    }
}
