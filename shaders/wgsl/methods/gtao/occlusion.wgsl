// Ambient occlusion by visibility bitmasks before its blur, one invocation a pixel.
// The plain version is render/src/methods/gtao/reference.rs.

#import shared/slices
#import shared/surface_valid

@group(0) @binding(4) var<storage, read_write> openness: array<f32>;

// Only what is covered counts.
fn sent(index: u32, toward: vec3f) -> vec3f {
    return vec3f(0.0);
}

@compute @workgroup_size(TILE, TILE)
fn occlude(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= slices.width || id.y >= slices.height {
        return;
    }
    let index = id.y * slices.width + id.x;
    if surface_valid(index) {
        openness[index] = gather(id.xy).open;
    } else {
        openness[index] = 1.0;
    }
}
