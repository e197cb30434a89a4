// The g-buffer's raster pass: what the materials say of the nearest surface of each pixel, in eight words.
// Positions follow from the depth buffer. The same as render/src/intersection.rs and scene/material.rs
// compute for a ray.

#import shared/packing
#import shared/view
#import uniforms/frame_view
#import uniforms/material_record

@group(0) @binding(0) var<uniform> view: FrameView;
@group(1) @binding(0) var<uniform> material: MaterialRecord;
@group(1) @binding(1) var base_texture: texture_2d<f32>;
@group(1) @binding(2) var gloss_texture: texture_2d<f32>;
@group(1) @binding(3) var normal_texture: texture_2d<f32>;
@group(1) @binding(4) var emission_texture: texture_2d<f32>;
@group(1) @binding(5) var base_sampler: sampler;
@group(1) @binding(6) var gloss_sampler: sampler;
@group(1) @binding(7) var normal_sampler: sampler;
@group(1) @binding(8) var emission_sampler: sampler;

const LEAST_COSINE = 1e-3;

struct Corner {
    @builtin(position) clip: vec4f,
    // From the eye, world axes, metres.
    @location(0) offset: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) displacement: vec3f,
    // How far it came since the frame before.
    @location(4) way: vec3f,
    @location(5) uv: vec4f,
    @location(6) colour: vec4f,
    @location(7) @interpolate(flat) mesh: u32,
}

@vertex
fn corner(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) displacement: vec3f,
    @location(4) way: vec3f,
    @location(5) uv: vec4f,
    @location(6) colour: vec4f,
    @builtin(instance_index) mesh: u32,
) -> Corner {
    let offset = position - view.eye.xyz;
    return Corner(clip_position(offset, view), offset, normal, tangent, displacement, way, uv, colour, mesh);
}

// Coordinates of a slot: its set, moved by its transform.
fn slot_uv(uv: vec4f, linear: vec4f, rest: vec4f) -> vec2f {
    let both = select(uv.xy, uv.zw, rest.z == 1.0);
    return linear.xy * both.x + linear.zw * both.y + rest.xy;
}

// A unit vector at right angles to another, the one that glam takes.
fn any_orthonormal(normal: vec3f) -> vec3f {
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    return vec3f(normal.x * normal.y * a, sign + normal.y * normal.y * a, -normal.y);
}

// The unit vector along which u grows, at right angles to the normal, and the sign of the bitangent. Where
// the mesh has no tangents both follow from how the place and the mesh's own coordinates, which no transform
// has moved, change in the image.
fn tangent_of(tangent: vec4f, normal: vec3f, places: array<vec3f, 2>, uvs: array<vec2f, 2>, front: bool) -> vec4f {
    var along = tangent.xyz;
    var sign = select(-1.0, 1.0, tangent.w >= 0.0);
    if all(tangent == vec4f(0.0)) {
        let orientation = select(-1.0, 1.0, uvs[0].x * uvs[1].y - uvs[0].y * uvs[1].x >= 0.0);
        along = (places[0] * uvs[1].y - places[1] * uvs[0].y) * orientation;
        // To the right and down is left-handed about what faces the viewer, as a front's normal does.
        sign = select(-orientation, orientation, front);
    }
    along -= normal * dot(normal, along);
    let length = length(along);
    if length > 0.0 {
        return vec4f(along / length, sign);
    }
    return vec4f(any_orthonormal(normal), sign);
}

// A shading normal that does not look away from the viewer.
fn leaning_to(normal: vec3f, to_viewer: vec3f, geometric: vec3f) -> vec3f {
    let cosine = dot(normal, to_viewer);
    let lifted = normal + to_viewer * max(LEAST_COSINE - cosine, 0.0);
    let length = length(lifted);
    return select(geometric, lifted / length, length > 0.0);
}

// Movement in the image of a point displaced around where it is now; where an end is behind the eye, as it
// moves in the middle (render/src/gbuffer.rs).
fn movement(offset: vec3f, displacement: vec3f) -> vec2f {
    let opening = offset - 0.5 * displacement;
    let closing = offset + 0.5 * displacement;
    if dot(opening, view.back.xyz) < 0.0 && dot(closing, view.back.xyz) < 0.0 {
        return in_image(closing, view) - in_image(opening, view);
    }
    let at = to_view(offset, view);
    let way = to_view(displacement, view);
    return (way.xy - at.xy * (way.z / at.z)) * view.focal_length / -at.z;
}

struct Words {
    @location(0) first: vec4u,
    @location(1) second: vec4u,
}

@fragment
fn surface(in: Corner, @builtin(front_facing) front: bool) -> Words {
    let across = dpdx(in.offset);
    let down = dpdy(in.offset);
    let mesh_uv = select(in.uv.xy, in.uv.zw, material.normal_rest.z == 1.0);
    let uvs = array<vec2f, 2>(dpdx(mesh_uv), dpdy(mesh_uv));

    let base = material.base * in.colour
        * textureSampleLevel(base_texture, base_sampler, slot_uv(in.uv, material.base_linear, material.base_rest), 0.0);
    if base.a < material.factors.z {
        discard;
    }
    let gloss = textureSampleLevel(gloss_texture, gloss_sampler, slot_uv(in.uv, material.gloss_linear, material.gloss_rest), 0.0);
    let metallic = clamp(material.factors.x * gloss.b, 0.0, 1.0);
    let roughness = clamp(material.factors.y * gloss.g, 0.0, 1.0);
    let emission_uv = slot_uv(in.uv, material.emission_linear, material.emission_rest);
    let emission = material.emission.rgb * textureSampleLevel(emission_texture, emission_sampler, emission_uv, 0.0).rgb;

    let to_viewer = select(view.back.xyz, normalize(-in.offset), view.perspective == 1u);
    var geometric = normalize(cross(across, down));
    geometric = select(geometric, -geometric, dot(geometric, to_viewer) < 0.0);
    // Where the mesh has no normals, its triangles are flat.
    let flat_normal = select(-geometric, geometric, front);
    let smooth_length = length(in.normal);
    let smooth_normal = select(flat_normal, in.normal / smooth_length, smooth_length > 0.0);
    let normal_uv = slot_uv(in.uv, material.normal_linear, material.normal_rest);
    let texel = textureSampleLevel(normal_texture, normal_sampler, normal_uv, 0.0).xyz * 2.0 - 1.0;
    let tilted = texel * vec3f(material.emission.ww, 1.0);
    let tangent = tangent_of(in.tangent, smooth_normal, array<vec3f, 2>(across, down), uvs, front);
    let bitangent = cross(smooth_normal, tangent.xyz) * tangent.w;
    let bumpy = normalize(tangent.xyz * tilted.x + bitangent * tilted.y + smooth_normal * tilted.z);
    let mapped = select(smooth_normal, bumpy, material.emission.w != 0.0);
    let side = select(1.0, -1.0, dot(smooth_normal, geometric) < 0.0);
    let normal = leaning_to(side * mapped, to_viewer, geometric);

    let colour = clamp(base.rgb, vec3f(0.0), vec3f(1.0));
    let coarse = pack4x8snorm(vec4f(to_octahedron(geometric), 0.0, 0.0)) & 0xffffu;
    return Words(
        vec4u(
            pack2x16snorm(to_octahedron(normal)),
            coarse | (u32(floor(roughness * 65535.0 + 0.5)) << 16u),
            pack2x16unorm(colour.rg),
            pack2x16unorm(vec2f(colour.b, metallic)),
        ),
        vec4u(
            pack_radiance(emission),
            in.mesh + 1u,
            pack2x16float(clamp(movement(in.offset, in.displacement), vec2f(-65504.0), vec2f(65504.0))),
            pack_way(in.way),
        ),
    );
}
