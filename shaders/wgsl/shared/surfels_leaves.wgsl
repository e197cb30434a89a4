// The box around the surfels of each leaf, and how far the one that reaches farthest does.

#import shared/surfel
#import shared/surfel_record
#import shared/surfel_tree

@group(0) @binding(0) var<storage, read> totals: Totals;
@group(0) @binding(1) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(2) var<storage, read_write> nodes: array<Node>;

@compute @workgroup_size(64)
fn bound_leaves(@builtin(global_invocation_id) id: vec3u) {
    let first = first_surfel(0u, id.x);
    if first >= totals.kept {
        return;
    }
    let end = min(first + LEAF, totals.kept);
    var low = surfels[first].place;
    var high = low;
    var reach = effect_distance(first);
    for (var i = first + 1u; i < end; i++) {
        low = min(low, surfels[i].place);
        high = max(high, surfels[i].place);
        reach = max(reach, effect_distance(i));
    }
    nodes[node_index(0u, id.x)] = Node(vec4f(low, reach), vec4f(high, 0.0));
}
