// A level of a Gaussian pyramid from the one below (Burt and Adelson 1983), half as wide and high. The plain
// version is render/src/methods/volume_shell/pyramid.rs.

#import uniforms/pyramid

@group(0) @binding(0) var<uniform> sizes: Pyramid;
// [fine_height, fine_width, 4]
@group(0) @binding(1) var<storage, read> fine: array<vec4f>;
// [coarse_height, coarse_width, 4]
@group(0) @binding(2) var<storage, read_write> coarse: array<vec4f>;

fn fine_at(x: i32, y: i32) -> vec4f {
    let at = clamp(vec2i(x, y), vec2i(0), vec2i(i32(sizes.fine_width), i32(sizes.fine_height)) - 1);
    return fine[u32(at.y) * sizes.fine_width + u32(at.x)];
}

// Four texels of a row, weighed 1, 3, 3 and 1.
fn row(x: i32, y: i32) -> vec4f {
    return (fine_at(x - 1, y) + fine_at(x + 2, y)) + 3.0 * (fine_at(x, y) + fine_at(x + 1, y));
}

@compute @workgroup_size(TILE, TILE)
fn reduce(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= sizes.coarse_width || id.y >= sizes.coarse_height {
        return;
    }
    let x = 2 * i32(id.x);
    let y = 2 * i32(id.y);
    let sum = (row(x, y - 1) + row(x, y + 2)) + 3.0 * (row(x, y) + row(x, y + 1));
    coarse[id.y * sizes.coarse_width + id.x] = sum / 64.0;
}
