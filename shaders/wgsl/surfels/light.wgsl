// Direct light of surfels, with shadows by the lights' maps (thesis 4.3, "One-bounce Indirect Illumination"),
// in a buffer of its own. `reflected`, `received` and `dimmed` import it, and bring `sent_of` and
// `passed_share`: what is kept of the light, and what a medium lets through.

#import shared/lights
#import shared/shadow
#import shared/surfel
#import shared/surfel_order
#import shared/surfel_patch_record
#import shared/surfel_record
#import shared/view
#import uniforms/frame_view
#import uniforms/light_record
#constant LIGHTS = 1

@group(0) @binding(0) var<uniform> view: FrameView;
@group(0) @binding(1) var<storage, read> patches: array<Patch>;
@group(0) @binding(2) var<storage, read> starts: array<u32>;
@group(0) @binding(3) var<storage, read> totals: Totals;
@group(0) @binding(4) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(5) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(6) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(7) var<storage, read> pictures: array<u32>;
@group(0) @binding(8) var maps: texture_depth_2d_array;
@group(0) @binding(9) var map_sampler: sampler_comparison;
@group(0) @binding(10) var<storage, read_write> sent: array<vec2u>;

@compute @workgroup_size(64)
fn light_surfels(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let surfel = surfels[id.x];
    let point = view.eye.xyz + from_view(surfel.place, view);
    let normal = from_view(surfel_normal(surfel), view);
    var front = vec3f(0.0);
    var back = vec3f(0.0);
    for (var i = 0u; i < LIGHTS; i++) {
        let arrived = arrival(lights[i], point);
        let cosine = dot(normal, arrived.direction);
        if cosine == 0.0 || all(arrived.irradiance == vec3f(0.0)) {
            continue;
        }
        let facing = select(-normal, normal, cosine > 0.0);
        let shown = lit_share(lights[i], point, facing, arrived.direction) * passed_share(point, arrived);
        let received = arrived.irradiance * abs(cosine) * shown;
        if cosine > 0.0 {
            front += received;
        } else {
            back += received;
        }
    }
    sent[id.x] = sent_of(front, back, patches[patch_of(chosen(id.x))]);
}
