// What lamps would send to the eye from each surface if nothing were in their way: by Phong's model, as the
// g-buffer's light is, of colours of 1, and by microfacets over a base that gets what they let through
// (render/src/path/bsdf.rs). Each by the base and by the specular lobe.

#import shared/facets
#import shared/lights
#import shared/phong_lobe
#import shared/surface
#import shared/surface_valid
#import shared/view
#import uniforms/frame_view
#import uniforms/light_record
#constant LIGHTS = 1

@group(0) @binding(0) var<uniform> view: FrameView;
// [3, height, width]
@group(0) @binding(4) var<storage, read> specular_planes: array<f32>;
// [height, width]
@group(0) @binding(5) var<storage, read> glossiness_plane: array<f32>;
@group(0) @binding(6) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(7) var<storage, read> pictures: array<u32>;
// [4, 3, height, width]: diffuse and specular by Phong, diffuse and specular by microfacets
@group(0) @binding(8) var<storage, read_write> lobes: array<f32>;

const PI = 3.14159265;
const MEAN_OF_FIFTH = 1.0 / 22.0;

// Microfacets, per steradian, without Fresnel's share (Walter et al. 2007).
fn facets(alpha: f32, viewer: f32, light: f32, halfway: f32) -> f32 {
    let density = facet_density(alpha, halfway, max(1.0 - halfway * halfway, 0.0));
    let both = 1.0 / (1.0 + hidden_facets(viewer, alpha) + hidden_facets(light, alpha));
    return density * both / (4.0 * viewer * light);
}

@compute @workgroup_size(TILE, TILE)
fn sum_lobes(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    var sums = array<vec3f, 4>(vec3f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0));
    if surface_valid(at) {
        let offset = from_view(surface_position(at, pixels), view);
        let normal = from_view(surface_normal(at, pixels), view);
        let to_camera = normalize(-offset);
        let seen = dot(normal, to_camera);
        let alpha = phong_alpha(1.0 - glossiness_plane[at]);
        let exponent = phong_exponent(alpha);
        let specular = vec3f(
            specular_planes[at], specular_planes[at + pixels], specular_planes[at + 2u * pixels]
        );
        let fresnel = fresnel_of(specular);
        let inverse_mean = 1.0 / max(1.0 - specular - fresnel.added * MEAN_OF_FIFTH, vec3f(1e-6));
        let mirrored = 2.0 * seen * normal - to_camera;
        for (var i = 0u; i < LIGHTS; i++) {
            let arrived = arrival(lights[i], view.eye.xyz + offset);
            let cosine = dot(normal, arrived.direction);
            if cosine <= 0.0 || all(arrived.irradiance == vec3f(0.0)) {
                continue;
            }
            let received = arrived.irradiance * cosine;
            sums[0] += received / PI;
            let along = dot(mirrored, arrived.direction);
            if along > 0.0 {
                sums[1] += received * (exponent + 2.0) / (2.0 * PI) * pow(min(along, 1.0), exponent);
            }
            if seen > 0.0 {
                let halfway = normalize(to_camera + arrived.direction);
                let through = (1.0 - fresnel_at(fresnel, seen)) * (1.0 - fresnel_at(fresnel, cosine));
                sums[2] += received / PI * through * inverse_mean;
                sums[3] += received * fresnel_at(fresnel, dot(to_camera, halfway))
                    * facets(alpha, seen, cosine, dot(normal, halfway));
            }
        }
    }
    for (var lobe = 0u; lobe < 4u; lobe++) {
        for (var c = 0u; c < 3u; c++) {
            lobes[at + (3u * lobe + c) * pixels] = sums[lobe][c];
        }
    }
}
