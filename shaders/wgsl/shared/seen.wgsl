// What is known of the surface at a pixel: the raster pass' words, unpacked.

#import shared/material
#import shared/packing
#import shared/view
#import uniforms/frame_view
#import uniforms/material_record

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var first_words: texture_2d<u32>;
@group(0) @binding(2) var second_words: texture_2d<u32>;
@group(0) @binding(3) var depths: texture_depth_2d;
@group(0) @binding(4) var<storage, read> mesh_materials: array<u32>;
@group(0) @binding(5) var<storage, read> materials: array<MaterialRecord>;

struct Seen {
    valid: bool,
    depth: f32,
    // View space, metres.
    position: vec3f,
    // From the eye, world axes, metres.
    offset: vec3f,
    // World axes, all facing the eye.
    normal: vec3f,
    geometric: vec3f,
    to_camera: vec3f,
    diffuse: vec3f,
    specular: vec3f,
    roughness: f32,
    mean_free_path: vec3f,
    emission: vec3f,
    // While the shutter is open, pixels, y up.
    movement: vec2f,
    // Since the frame before, world axes, metres.
    way: vec3f,
    mesh: u32,
}

fn seen_at(pixel: vec2u) -> Seen {
    var seen: Seen;
    let first = textureLoad(first_words, pixel, 0);
    let second = textureLoad(second_words, pixel, 0);
    let stored = textureLoad(depths, pixel, 0);
    seen.valid = second.y != 0u;
    if !seen.valid {
        return seen;
    }
    seen.depth = depth_of(stored, view);
    seen.position = view_position(vec2f(pixel) + 0.5, seen.depth, view);
    seen.offset = from_view(seen.position, view);
    seen.to_camera = select(view.back.xyz, normalize(-seen.offset), view.perspective == 1u);
    seen.normal = from_octahedron(unpack2x16snorm(first.x));
    seen.geometric = from_octahedron(unpack4x8snorm(first.y).xy);
    seen.mesh = second.y - 1u;
    let material = materials[mesh_materials[seen.mesh]];
    let last = unpack2x16unorm(first.w);
    let base = vec3f(unpack2x16unorm(first.z), last.x);
    let reflected = reflectance(material, base, last.y);
    seen.diffuse = reflected.diffuse;
    seen.specular = reflected.specular;
    seen.roughness = f32(first.y >> 16u) / 65535.0;
    seen.mean_free_path = material.gloss_path.yzw;
    seen.emission = unpack_radiance(second.x);
    seen.movement = unpack2x16float(second.z);
    seen.way = unpack_way(second.w);
    return seen;
}
