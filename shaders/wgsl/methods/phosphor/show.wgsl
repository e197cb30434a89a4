// What texels give back at each pixel (thesis, equation 8.3), linear between the three around it.

#import shared/glow_keeper
#import shared/glow_tile
#import uniforms/glow_tile
#import uniforms/paint_state
#constant PAINT_STATES = 1
#constant STATES = 1

@group(0) @binding(0) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(1) var<storage, read> tiles: array<GlowTile>;
// As step.wgsl has them.
@group(0) @binding(2) var<storage, read> owners: array<u32>;
@group(0) @binding(3) var<storage, read> found: array<vec4f>;
@group(0) @binding(4) var<storage, read> states: array<f32>;
// [3, height, width]
@group(0) @binding(5) var<storage, read_write> image: array<f32>;

struct Texels {
    at: vec3u,
    weights: vec3f,
}

// The texels around a place in a tile, `weights` being those of its second and third corner.
fn texels_around(tile: GlowTile, weights: vec2f) -> Texels {
    let divisions = tile.divisions;
    let inwards = drawn_in(divisions);
    var place = max((weights - inwards / 3.0) / (1.0 - inwards), vec2f(0.0));
    place *= f32(divisions) / max(place.x + place.y, 1.0);
    let column = min(u32(place.x), divisions - 1u);
    let row = min(u32(place.y), divisions - 1u - column);
    let part = place - vec2f(f32(column), f32(row));
    let here = row_start(row, divisions) + column;
    let above = row_start(row + 1u, divisions) + column;
    if part.x + part.y > 1.0 && column + row + 2u <= divisions {
        let far = vec3f(part.x + part.y - 1.0, 1.0 - part.y, 1.0 - part.x);
        return Texels(vec3u(above + 1u, here + 1u, above) + tile.first, far);
    }
    return Texels(vec3u(here, here + 1u, above) + tile.first, vec3f(1.0 - part.x - part.y, part));
}

@compute @workgroup_size(64)
fn show(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let pixel = id.x + id.y * groups.x * 64u;
    let pixels = arrayLength(&found);
    if pixel >= pixels {
        return;
    }
    let at = found[pixel];
    var sent = vec3f(0.0);
    if at.x > 0.0 {
        let tile = tiles[u32(at.x) - 1u];
        let around = texels_around(tile, at.yz);
        for (var s = 0u; s < STATES; s++) {
            var share = vec3f(0.0);
            for (var i = 0u; i < 3u; i++) {
                let texel = around.at[i];
                var factors = vec3f(1.0);
                if KEEPER_WORDS > 1u {
                    let first = texel * KEEPER_WORDS;
                    factors = keeper_factors(owners[first + 3u], owners[first + 4u]).rgb;
                }
                share += around.weights[i] * states[texel * STATES + s] * factors;
            }
            sent += paints[tile.paint * STATES + s].emission.rgb * share;
        }
    }
    for (var c = 0u; c < 3u; c++) {
        image[pixel + c * pixels] = sent[c];
    }
}
