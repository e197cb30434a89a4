// The tile of each pixel and where in it: the nearest tile of the pixel's object to where its surface is, by
// the tree of `fit`. What is farther away than rounding puts it is no tile of that surface.

#import shared/glow_corners
#import shared/glow_tile
#import shared/view
#import uniforms/frame_view
#import uniforms/glow_tile
#constant FAN = 8
#constant LEVELS = 1
#constant TILES = 1

@group(0) @binding(0) var<uniform> view: FrameView;
// Of each level, leaves first: its first node, its number of nodes.
@group(0) @binding(1) var<uniform> levels: array<vec4u, LEVELS>;
@group(0) @binding(2) var<storage, read> tiles: array<GlowTile>;
@group(0) @binding(3) var<storage, read> posed: array<f32>;
@group(0) @binding(4) var<storage, read> boxes: array<f32>;
@group(0) @binding(5) var<storage, read> valid_plane: array<f32>;
// [3, height, width], camera space, metres
@group(0) @binding(6) var<storage, read> position_planes: array<f32>;
@group(0) @binding(7) var<storage, read> object_plane: array<f32>;
// [height, width]: the tile, counted from 1, 0 where there is none; weights of its second and third corner
@group(0) @binding(8) var<storage, read_write> found: array<vec4f>;

// How far from its tile a pixel may seem to be, over its depth and over its distance from the origin.
const TOLERANCE = 1e-3;
const ROUNDING = 1e-5;

fn off_box(point: vec3f, node: u32) -> f32 {
    let at = 6u * node;
    let low = vec3f(boxes[at], boxes[at + 1u], boxes[at + 2u]);
    let high = vec3f(boxes[at + 3u], boxes[at + 4u], boxes[at + 5u]);
    return distance(point, clamp(point, low, high));
}

struct Near {
    off: f32,
    weights: vec2f,
}

// How far a point is from a triangle, and the weights of the second and third corner there.
fn near_triangle(point: vec3f, corners: mat3x3f) -> Near {
    let u = corners[1] - corners[0];
    let v = corners[2] - corners[0];
    let way = point - corners[0];
    let uu = dot(u, u);
    let uv = dot(u, v);
    let vv = dot(v, v);
    let denominator = uu * vv - uv * uv;
    let scale = select(0.0, 1.0 / denominator, denominator > 0.0);
    let a = dot(way, u);
    let b = dot(way, v);
    var weights = max(vec2f(vv * a - uv * b, uu * b - uv * a) * scale, vec2f(0.0));
    weights /= max(weights.x + weights.y, 1.0);
    return Near(distance(way, u * weights.x + v * weights.y), weights);
}

@compute @workgroup_size(TILE, TILE)
fn find(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let pixel = id.y * view.width + id.x;
    let seen = vec3f(position_planes[pixel], position_planes[pixel + pixels], position_planes[pixel + 2u * pixels]);
    let point = view.eye.xyz + from_view(seen, view);
    let object = u32(object_plane[pixel] + 0.5);
    var least = TOLERANCE * abs(seen.z) + ROUNDING * length(point);
    var best = vec4f(0.0);
    // Downwards and to the right through a tree that is complete but for its last nodes.
    var height = LEVELS - 1u;
    var node = 0u;
    var goes_on = valid_plane[pixel] > 0.5;
    while goes_on {
        let is_near = off_box(point, levels[height].x + node) <= least;
        if is_near && height > 0u {
            height -= 1u;
            node *= FAN;
            continue;
        }
        if is_near {
            let end = min((node + 1u) * FAN, TILES);
            for (var tile = node * FAN; tile < end; tile++) {
                let near = near_triangle(point, corners_of(tile_vertices(tiles[tile])));
                if near.off < least && tiles[tile].object == object {
                    least = near.off;
                    best = vec4f(f32(tile + 1u), near.weights, 0.0);
                }
            }
        }
        // The last of its siblings leads up.
        while height < LEVELS - 1u && ((node + 1u) % FAN == 0u || node + 1u >= levels[height].y) {
            node /= FAN;
            height += 1u;
        }
        goes_on = height < LEVELS - 1u;
        node += 1u;
    }
    found[pixel] = best;
}
