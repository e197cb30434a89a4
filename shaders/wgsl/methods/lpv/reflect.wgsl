// Light that surfels reflect of what others emit, which a grid has brought to them. What the back of a closed
// body's surface would get is in it.

#import shared/lpv_irradiance
#import shared/lpv_send
#import shared/surfel
#import shared/surfel_order
#import shared/surfel_patch_record
#import shared/surfel_record
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> totals: Totals;
@group(0) @binding(3) var<storage, read> surfels: array<Surfel>;
@group(0) @binding(4) var<storage, read> patches: array<Patch>;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(5) var<storage, read_write> light: array<atomic<u32>>;
// [3, cells]: emitted light
@group(0) @binding(6) var<storage, read> shown: array<vec4f>;
@group(0) @binding(7) var<storage, read> starts: array<u32>;

@compute @workgroup_size(64)
fn reflect_emitted(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let surfel = surfels[id.x];
    let point = view.eye.xyz + from_view(surfel.place, view);
    let normal = from_view(surfel_normal(surfel), view);
    let radius = surfel_radius(surfel);
    let reflected = PI * radius * radius * patch_colour(patches[patch_of(chosen(id.x))]);
    send(point, normal, reflected * irradiance(point, normal, 0u));
    if surfel_is_open(surfel) {
        send(point, -normal, reflected * irradiance(point, -normal, 0u));
    }
}
