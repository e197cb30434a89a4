// Boxes around tiles as they are posed in this frame: the tree by which a pixel finds its tile. A node is of
// FAN tiles, or of FAN nodes of the level below; lows and highs lie one after the other.

#import shared/glow_corners
#import shared/glow_tile
#import uniforms/glow_tile
#constant FAN = 8
#constant LEAVES = 1

/// A level of the tree over tiles.
struct GlowLevel {
    /// Its nodes.
    nodes: u32,
    /// The nodes, or tiles, of the level below.
    children: u32,
    /// Its first node.
    first: u32,
    /// The first node of the level below.
    first_child: u32,
}

@group(0) @binding(0) var<uniform> level: GlowLevel;
@group(0) @binding(1) var<storage, read> tiles: array<GlowTile>;
@group(0) @binding(2) var<storage, read> posed: array<f32>;
@group(0) @binding(3) var<storage, read_write> boxes: array<f32>;

fn box_corner(at: u32) -> vec3f {
    return vec3f(boxes[at], boxes[at + 1u], boxes[at + 2u]);
}

@compute @workgroup_size(64)
fn fit(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let node = id.x + id.y * groups.x * 64u;
    if node >= level.nodes {
        return;
    }
    var low = vec3f(3e38);
    var high = vec3f(-3e38);
    let end = min((node + 1u) * FAN, level.children);
    for (var child = node * FAN; child < end; child++) {
        if LEAVES == 1u {
            let corners = corners_of(tile_vertices(tiles[child]));
            low = min(low, min(corners[0], min(corners[1], corners[2])));
            high = max(high, max(corners[0], max(corners[1], corners[2])));
        } else {
            let at = 6u * (level.first_child + child);
            low = min(low, box_corner(at));
            high = max(high, box_corner(at + 3u));
        }
    }
    let at = 6u * (level.first + node);
    for (var axis = 0u; axis < 3u; axis++) {
        boxes[at + axis] = low[axis];
        boxes[at + 3u + axis] = high[axis];
    }
}
