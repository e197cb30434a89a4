// Facets from patches, and the box around those of each leaf of the tree over them.

#import shared/facet
#import shared/patch_corners
#import shared/surfel
#import shared/surfel_patch_record
#import shared/surfel_tree
#constant HEIGHT = 10

@group(0) @binding(0) var<storage, read> vertices: array<f32>;
@group(0) @binding(1) var<storage, read> patches: array<Patch>;
@group(0) @binding(2) var<storage, read_write> facets: array<Facet>;
@group(0) @binding(3) var<storage, read_write> nodes: array<Node>;

fn numbers(at: vec3f) -> array<f32, 3> {
    return array<f32, 3>(at.x, at.y, at.z);
}

@compute @workgroup_size(64)
fn place_facets(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let leaf = id.x + id.y * groups.x * 64u;
    let first = first_surfel(0u, leaf);
    let end = min(first + LEAF, arrayLength(&patches));
    if first >= end {
        return;
    }
    var low = vec3f(0x1p126);
    var high = -low;
    for (var i = first; i < end; i++) {
        let one = patches[i];
        let triangle = mat3x3f(
            camera_space(one.corners[0]), camera_space(one.corners[1]), camera_space(one.corners[2])
        );
        let corners = triangle * patch_weights(one.part);
        facets[i] = Facet(numbers(corners[0]), numbers(corners[1]), numbers(corners[2]), one.part);
        low = min(low, min(corners[0], min(corners[1], corners[2])));
        high = max(high, max(corners[0], max(corners[1], corners[2])));
    }
    nodes[node_index(0u, leaf)] = Node(vec4f(low, 0.0), vec4f(high, 0.0));
}
