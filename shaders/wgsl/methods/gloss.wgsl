// What glossy receivers read of each pixel in one buffer, since passes have no more than eight: specular
// colour and glossiness.

// Attributes, [channels, height, width].
@group(0) @binding(0) var<storage, read> valid: array<f32>;
@group(0) @binding(1) var<storage, read> specular: array<f32>;
@group(0) @binding(2) var<storage, read> glossiness: array<f32>;
// [height, width]: specular colour; glossiness, -1 where no surface is seen.
@group(0) @binding(3) var<storage, read_write> gloss: array<vec4f>;

@compute @workgroup_size(64)
fn gather_gloss(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let at = id.x + id.y * groups.x * 64u;
    let pixels = arrayLength(&gloss);
    if at >= pixels {
        return;
    }
    let colour = vec3f(specular[at], specular[at + pixels], specular[at + 2u * pixels]);
    gloss[at] = vec4f(colour, select(-1.0, glossiness[at], valid[at] > 0.5));
}
