// Openness into the texture that Bevy's materials read.

@group(0) @binding(0) var<storage, read> openness: array<f32>;
@group(0) @binding(1) var texture: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8)
fn write_openness(@builtin(global_invocation_id) id: vec3u) {
    let size = textureDimensions(texture);
    if (any(id.xy >= size)) { return; }
    textureStore(texture, id.xy, vec4f(openness[id.y * size.x + id.x], 0.0, 0.0, 0.0));
}
