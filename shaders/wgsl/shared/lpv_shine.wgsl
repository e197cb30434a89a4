// Light that surfels send by themselves: what they emit or give back.

#import shared/lpv_send
#import shared/surfel
#import shared/surfel_record
#import shared/view
#import uniforms/frame_view
#import uniforms/light_grid

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> totals: Totals;
@group(0) @binding(3) var<storage, read> surfels: array<Surfel>;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(5) var<storage, read_write> light: array<atomic<u32>>;

@compute @workgroup_size(64)
fn shine(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let surfel = surfels[id.x];
    let point = view.eye.xyz + from_view(surfel.place, view);
    let normal = from_view(surfel_normal(surfel), view);
    let radius = surfel_radius(surfel);
    let area = PI * radius * radius;
    let sent = own_radiance(id.x, surfel);
    send(point, normal, PI * area * sent[0]);
    send(point, -normal, PI * area * sent[1]);
}
