// What surfaces reflect to the eye of light that comes from everywhere alike.

#import shared/facets
#import shared/surface
#import uniforms/frame_view

@group(0) @binding(0) var<uniform> view: FrameView;
// [3, height, width] each
@group(0) @binding(3) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(4) var<storage, read> specular_planes: array<f32>;
// [height, width] each
@group(0) @binding(5) var<storage, read> glossiness_plane: array<f32>;
@group(0) @binding(6) var<storage, read> object_plane: array<f32>;
// [PLACES, PLACES], cosines by roughnesses, and then an entry an object, whose x is 1 for microfacets
@group(0) @binding(7) var<storage, read> directional: array<vec2f>;
// [3, height, width]
@group(0) @binding(8) var<storage, read_write> reflectances: array<f32>;

// Rows and columns of the table.
const PLACES = 17u;

// What microfacets reflect to a viewer of light from everywhere that reflect all, and that reflect
// (1 - cos)^5: render/src/path/bsdf/albedo.rs.
fn specular_shares(roughness: f32, cosine: f32) -> vec2f {
    let at = clamp(vec2f(roughness, cosine), vec2f(0.0), vec2f(1.0)) * f32(PLACES - 1u);
    let low = min(vec2u(at), vec2u(PLACES - 2u));
    let part = at - vec2f(low);
    let first = low.y * PLACES + low.x;
    let row = mix(directional[first], directional[first + 1u], part.x);
    let next = mix(directional[first + PLACES], directional[first + PLACES + 1u], part.x);
    return mix(row, next, part.y);
}

// What a surface reflects to the eye of light from everywhere.
fn reflectance(at: u32, pixels: u32) -> vec3f {
    let diffuse = vec3f(diffuse_planes[at], diffuse_planes[at + pixels], diffuse_planes[at + 2u * pixels]);
    let specular = vec3f(
        specular_planes[at], specular_planes[at + pixels], specular_planes[at + 2u * pixels]
    );
    let object = PLACES * PLACES + u32(object_plane[at]);
    if directional[min(object, arrayLength(&directional) - 1u)].x == 0.0 {
        return diffuse + specular;
    }
    // Where no surface is seen its place is 0.
    let place = surface_position(at, pixels);
    let cosine = clamp(-dot(surface_normal(at, pixels), place) / max(length(place), 1e-30), 0.0, 1.0);
    let fresnel = fresnel_of(specular);
    let shares = specular_shares(1.0 - glossiness_plane[at], cosine);
    return diffuse * (1.0 - fresnel_at(fresnel, cosine)) + specular * shares.x + fresnel.added * shares.y;
}

@compute @workgroup_size(TILE, TILE)
fn reflect_all(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    let share = reflectance(at, pixels);
    for (var c = 0u; c < 3u; c++) {
        reflectances[at + c * pixels] = share[c];
    }
}
