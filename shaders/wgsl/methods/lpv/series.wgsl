// By how much to multiply what the last iteration shows, so that it stands for all that would follow:
// render/src/lpv/series.rs.

#import shared/lpv_kinds
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [64, kinds] each: energies after the three iterations before the last
@group(0) @binding(1) var<storage, read> first: array<vec4f>;
@group(0) @binding(2) var<storage, read> second: array<vec4f>;
@group(0) @binding(3) var<storage, read> third: array<vec4f>;
// [kinds]
@group(0) @binding(4) var<storage, read_write> weights: array<vec4f>;

const PARTS = 64u;
const MOST = 0.995;
const GROWS = 1e-3;

fn weight(first: f32, second: f32, third: f32) -> f32 {
    let after = third / max(second, 1e-37);
    if first <= 0.0 || second <= 0.0 || third < 0.0 || after > 1.0 + GROWS {
        return 1.0;
    }
    let ratio = min(after, MOST);
    let unsteady = abs(after - second / first) / (1.0 - ratio);
    return 1.0 + clamp(2.0 - 10.0 * unsteady, 0.0, 1.0) * ratio / (1.0 - ratio);
}

@compute @workgroup_size(64)
fn weigh(@builtin(local_invocation_index) light: u32) {
    if light >= KINDS {
        return;
    }
    var sums = mat3x3f();
    for (var part = 0u; part < PARTS; part++) {
        let at = KINDS * part + light;
        sums += mat3x3f(first[at].rgb, second[at].rgb, third[at].rgb);
    }
    for (var c = 0u; c < 3u; c++) {
        weights[light][c] = weight(sums[0][c], sums[1][c], sums[2][c]);
    }
}
