// Light that surfels emit. What the back of a closed body's surface emits stays in it.

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> totals: Totals;
@group(0) @binding(3) var<storage, read> surfels: array<Surfel>;
// Of patches: emitted radiance, packed.
@group(0) @binding(4) var<storage, read> emissions: array<u32>;
// [cells, 3, 4, 2]: flux and energy of each colour, as lpv_send.wgsl has them
@group(0) @binding(5) var<storage, read_write> light: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> starts: array<u32>;

@compute @workgroup_size(64)
fn shine(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= totals.kept {
        return;
    }
    let surfel = surfels[id.x];
    let emission = unpack_radiance(emissions[patch_of(chosen(id.x))]);
    if all(emission == vec3f(0.0)) {
        return;
    }
    let point = view.eye.xyz + from_view(surfel.place, view);
    let normal = from_view(surfel_normal(surfel), view);
    let radius = surfel_radius(surfel);
    let power = PI * PI * radius * radius * emission;
    send(point, normal, power);
    if surfel_is_open(surfel) {
        send(point, -normal, power);
    }
}
