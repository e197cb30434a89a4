// Direct light of lights without an extent, with shadows by their maps: the attributes `L` and `Ldiff`,
// planes [3, height, width] (thesis 7.3.1), dimmed by the medium on their way to surfaces. The exact one is
// render/src/path/direct.rs, but for blended surfaces: here they throw a full shadow from half opacity on and
// none below, there they dim.

#import shared/light_dimmed
#import shared/lights
#import shared/phong_lobe
#import shared/seen
#import shared/shadow
#import uniforms/frame_view
#import uniforms/light_record
#constant LIGHTS = 1

const PI = 3.14159265;

@group(0) @binding(6) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(7) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(8) var<storage, read> pictures: array<u32>;
@group(0) @binding(9) var maps: texture_depth_2d_array;
@group(0) @binding(10) var map_sampler: sampler_comparison;
@group(0) @binding(13) var<storage, read_write> light_planes: array<f32>;
@group(0) @binding(14) var<storage, read_write> diffuse_planes: array<f32>;

@compute @workgroup_size(TILE, TILE)
fn gather_light(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let seen = seen_at(id.xy);
    var diffuse = vec3f(0.0);
    var specular = vec3f(0.0);
    if seen.valid {
        let point = view.eye.xyz + seen.offset;
        let exponent = phong_exponent(phong_alpha(seen.roughness));
        let mirrored = reflect(-seen.to_camera, seen.normal);
        for (var i = 0u; i < LIGHTS; i++) {
            let light = lights[i];
            let arrived = arrival(light, point);
            let cosine = dot(seen.normal, arrived.direction);
            if cosine <= 0.0 || dot(seen.geometric, arrived.direction) <= 0.0 || all(arrived.irradiance == vec3f(0.0)) {
                continue;
            }
            let lit = lit_share(light, point, seen.geometric, arrived.direction);
            let received = arrived.irradiance * cosine * lit * passed_share(point, arrived);
            diffuse += received * seen.diffuse / PI;
            let along = dot(mirrored, arrived.direction);
            if along > 0.0 {
                specular += received * seen.specular * (exponent + 2.0) / (2.0 * PI) * pow(min(along, 1.0), exponent);
            }
        }
    }
    let pixels = view.width * view.height;
    let index = id.y * view.width + id.x;
    for (var c = 0u; c < 3u; c++) {
        light_planes[index + c * pixels] = diffuse[c] + specular[c];
        diffuse_planes[index + c * pixels] = diffuse[c];
    }
}
