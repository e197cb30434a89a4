// Poses the vertices that move: morph targets, then the joints that a vertex follows, into the world (glTF
// 2.0, 3.7.2.2 and 3.7.3); and how far each goes while the shutter is open. What was its place becomes its
// place before. The plain version is render/src/scene/gltf.

/// What `frame/pose` reads.
struct Pose {
    /// How many vertices move.
    vertices: u32,
    /// Workgroups in x; there may be more in y.
    groups: u32,
    /// Matrices of a moment.
    matrices: u32,
    /// Morph weights of a moment.
    weights: u32,
    /// 1 in the first frame, which has none before it.
    first: u32,
}

@group(0) @binding(0) var<uniform> pose: Pose;
// A vertex: position, normal, tangent with sign, 10 numbers.
@group(0) @binding(1) var<storage, read> rest: array<f32>;
// A vertex: first influence, number of influences, first morph displacement, number of targets, first morph
// weight.
@group(0) @binding(2) var<storage, read> followers: array<u32>;
// An influence: matrix and, as bits, weight.
@group(0) @binding(3) var<storage, read> influences: array<vec2u>;
// Of all moving meshes, three rows a matrix: now, when the shutter opens, when it closes.
@group(0) @binding(4) var<storage, read> matrices: array<vec4f>;
// Displacements of positions, normals and tangents, 9 numbers for a target of a vertex.
@group(0) @binding(5) var<storage, read> targets: array<f32>;
// Of morph targets: now, when the shutter opens, when it closes.
@group(0) @binding(6) var<storage, read> target_weights: array<f32>;
@group(0) @binding(7) var<storage, read_write> posed: array<f32>;

struct Vertex {
    position: vec3f,
    normal: vec3f,
    tangent: vec3f,
}

fn triple(first: u32) -> vec3f {
    return vec3f(rest[first], rest[first + 1u], rest[first + 2u]);
}

fn target_triple(first: u32) -> vec3f {
    return vec3f(targets[first], targets[first + 1u], targets[first + 2u]);
}

fn morphed(vertex: u32, moment: u32) -> Vertex {
    var at = Vertex(triple(10u * vertex), triple(10u * vertex + 3u), triple(10u * vertex + 6u));
    let first = followers[5u * vertex + 2u];
    let weights = moment * pose.weights + followers[5u * vertex + 4u];
    for (var i = 0u; i < followers[5u * vertex + 3u]; i++) {
        let weight = target_weights[weights + i];
        let target_at = 9u * (first + i);
        at.position += weight * target_triple(target_at);
        at.normal += weight * target_triple(target_at + 3u);
        at.tangent += weight * target_triple(target_at + 6u);
    }
    return at;
}

// The three rows of the mean of the matrices that a vertex follows: at least one, and their weights add up to
// more than 0.
fn followed(vertex: u32, moment: u32) -> array<vec4f, 3> {
    var rows = array<vec4f, 3>(vec4f(0.0), vec4f(0.0), vec4f(0.0));
    var total = 0.0;
    let first = followers[5u * vertex];
    for (var i = first; i < first + followers[5u * vertex + 1u]; i++) {
        let matrix = 3u * (moment * pose.matrices + influences[i].x);
        let weight = bitcast<f32>(influences[i].y);
        rows[0] += weight * matrices[matrix];
        rows[1] += weight * matrices[matrix + 1u];
        rows[2] += weight * matrices[matrix + 2u];
        total += weight;
    }
    return array<vec4f, 3>(rows[0] / total, rows[1] / total, rows[2] / total);
}

fn placed(rows: array<vec4f, 3>, point: vec4f) -> vec3f {
    return vec3f(dot(rows[0], point), dot(rows[1], point), dot(rows[2], point));
}

fn unit(vector: vec3f) -> vec3f {
    let length = length(vector);
    return select(vec3f(0.0), vector / length, length > 0.0);
}

fn write_triple(first: u32, value: vec3f) {
    posed[first] = value.x;
    posed[first + 1u] = value.y;
    posed[first + 2u] = value.z;
}

@compute @workgroup_size(64)
fn pose_vertices(@builtin(global_invocation_id) id: vec3u) {
    let vertex = id.x + id.y * 64u * pose.groups;
    if vertex >= pose.vertices {
        return;
    }
    let now = morphed(vertex, 0u);
    let rows = followed(vertex, 0u);
    let position = placed(rows, vec4f(now.position, 1.0));
    let opens = placed(followed(vertex, 1u), vec4f(morphed(vertex, 1u).position, 1.0));
    let closes = placed(followed(vertex, 2u), vec4f(morphed(vertex, 2u).position, 1.0));
    // Normals go by the matrix of cofactors, whose sign is put right for mirroring matrices.
    let cofactors = array<vec3f, 3>(
        cross(rows[1].xyz, rows[2].xyz),
        cross(rows[2].xyz, rows[0].xyz),
        cross(rows[0].xyz, rows[1].xyz),
    );
    let mirrored = dot(rows[0].xyz, cofactors[0]) < 0.0;
    let normal = vec3f(dot(cofactors[0], now.normal), dot(cofactors[1], now.normal), dot(cofactors[2], now.normal));
    let sign = rest[10u * vertex + 9u];
    let at = 16u * vertex;
    let before = vec3f(posed[at], posed[at + 1u], posed[at + 2u]);
    write_triple(at, position);
    write_triple(at + 3u, unit(select(normal, -normal, mirrored)));
    write_triple(at + 6u, unit(placed(rows, vec4f(now.tangent, 0.0))));
    posed[at + 9u] = select(sign, -sign, mirrored);
    write_triple(at + 10u, closes - opens);
    write_triple(at + 13u, select(position - before, vec3f(0.0), pose.first == 1u));
}
