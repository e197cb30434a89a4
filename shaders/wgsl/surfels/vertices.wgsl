// Where vertices are in camera space, without what else is known of them. Passes over a scene's surface bind
// all places at once; what is drawn may be more than a binding holds, so that this pass runs over a part of
// it at a time.

#import shared/view
#import uniforms/frame_view

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<storage, read> posed: array<f32>;
@group(0) @binding(2) var<storage, read_write> vertices: array<f32>;

// Numbers of a vertex, of which the first three are its position in world space.
const POSED = 16u;

@compute @workgroup_size(64)
fn move_vertices(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let vertex = id.x + id.y * groups.x * 64u;
    if vertex >= arrayLength(&posed) / POSED {
        return;
    }
    let first = vertex * POSED;
    let place = to_view(vec3f(posed[first], posed[first + 1u], posed[first + 2u]) - view.eye.xyz, view);
    vertices[3u * vertex] = place.x;
    vertices[3u * vertex + 1u] = place.y;
    vertices[3u * vertex + 2u] = place.z;
}
