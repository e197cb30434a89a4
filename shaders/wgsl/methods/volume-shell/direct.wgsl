// Direct single scattering by the transmittance interval map (Nalbach, Ritschel and Seidel 2014, 4.3): what
// of the lamps' light, with shadows by their maps and dimmed on its way, the intervals of a ray scatter to
// the eye. The plain version is render/src/methods/volume_shell/direct.rs.

#import shared/intervals_decode
#import shared/intervals_decode_wide
#import shared/single_scattering
#import shared/view
#import uniforms/frame_view
#import uniforms/light_record
#import uniforms/volume_shell
#constant LIGHTS = 1
#constant SAMPLES = 16

@group(0) @binding(0) var<uniform> volume: VolumeShell;
@group(0) @binding(1) var<uniform> view: FrameView;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(4) var<storage, read> pictures: array<u32>;
@group(0) @binding(5) var maps: texture_depth_2d_array;
@group(0) @binding(6) var map_sampler: sampler_comparison;
@group(0) @binding(7) var<storage, read> rays: array<vec4f>;
@group(0) @binding(8) var<storage, read> samples: array<array<u32, SAMPLES / 2u>>;
// [3, height, width]
@group(0) @binding(9) var<storage, read_write> image: array<f32>;

// What a point of the ray scatters of the lamps' light, of all that is scattered there.
fn scattered_at(point: vec3f, direction: vec3f) -> vec3f {
    var sum = vec3f(0.0);
    for (var i = 0u; i < LIGHTS; i++) {
        sum += scattered_of(lights[i], point, direction, volume.nearest);
    }
    return sum;
}

@compute @workgroup_size(TILE, TILE)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    let record = rays[at];
    let direction = from_view(normalize(view_position(vec2f(id.xy) + 0.5, 1.0, view)), view);
    read_intervals(samples[at], record, volume.steps);
    var sum = vec3f(0.0);
    if record.y > record.x && record.z > 0.0 {
        for (var i = 0u; i < INTERVALS; i++) {
            sum += weights[i] * scattered_at(view.eye.xyz + points[i] * direction, direction);
        }
    }
    for (var c = 0u; c < 3u; c++) {
        image[at + c * pixels] = sum[c];
    }
}
