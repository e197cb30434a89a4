// The box around the four nodes below each of one height.

#import shared/surfel
#import shared/surfel_tree

/// A level of the tree over surfels.
struct TreeLevel {
    /// 0 for leaves.
    height: u32,
}

@group(0) @binding(0) var<uniform> level: TreeLevel;
@group(0) @binding(1) var<storage, read> totals: Totals;
@group(0) @binding(2) var<storage, read_write> nodes: array<Node>;

@compute @workgroup_size(64)
fn bound_parents(@builtin(global_invocation_id) id: vec3u) {
    if first_surfel(level.height, id.x) >= totals.kept {
        return;
    }
    var all = nodes[node_index(level.height - 1u, 4u * id.x)];
    for (var child = 4u * id.x + 1u; child < 4u * id.x + 4u; child++) {
        if first_surfel(level.height - 1u, child) < totals.kept {
            let one = nodes[node_index(level.height - 1u, child)];
            let low = vec4f(min(all.low.xyz, one.low.xyz), max(all.low.w, one.low.w));
            all = Node(low, vec4f(max(all.high.xyz, one.high.xyz), 0.0));
        }
    }
    nodes[node_index(level.height, id.x)] = all;
}
