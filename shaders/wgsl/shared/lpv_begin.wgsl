// Light of the lamps that the medium in each cell scatters: single scattering, which goes on from there but
// is not shown itself; of the lamps the mean of eight points of what of each cell lies in the medium; where
// the phase function has a mean cosine, light goes on along it. So it is with light that the scene sends by
// itself, which a grid has brought there.

#import shared/light_dimmed
#import shared/lights
#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lattice
#import shared/lpv_lobe
#import shared/lpv_medium
#import shared/lpv_part
#import shared/lpv_reflectance
#import shared/medium
#import shared/shadow
#import uniforms/frame_view
#import uniforms/light_grid
#import uniforms/light_record
#constant FACTORS = 0
#constant LIGHTS = 1
#constant UNSCATTERED = 2

@group(0) @binding(0) var<uniform> grid: LightGrid;
// [cells, 4]: as links.wgsl writes it
@group(0) @binding(1) var<storage, read> links: array<vec4u>;
@group(0) @binding(2) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(3) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(4) var<storage, read> pictures: array<u32>;
@group(0) @binding(5) var maps: texture_depth_2d_array;
@group(0) @binding(6) var map_sampler: sampler_comparison;
// [kinds, 3, cells]: lobes; then [cells]: what is sent out again
@group(0) @binding(7) var<storage, read_write> state: array<vec4f>;
// [cells, 3]: as media.wgsl writes it
@group(0) @binding(8) var<storage, read> media: array<vec4f>;

// Nearer to a lamp than this, in cells, a point counts as that near.
const NEAREST = 0.25;

// Of light that surfaces send into a cell and that collides there, what goes in: the rest goes back to them
// and comes again, in their colour.
fn sent_in(cell: u32, within: vec3f) -> vec3f {
    if FACTORS != PLACED {
        return vec3f(1.0);
    }
    let sets_out = 1.0 / max(mean_leaving(within), vec3f(1e-20));
    let way = sets_out / max(media[3u * cell + 2u].rgb, vec3f(1e-37));
    let opens = min(dot(COUNTS * SHARES, DISTANCES) / way, vec3f(1.0));
    let back = (1.0 - opens) * half_space(reduced_albedo()) * reflectance(cell);
    return opens / max(1.0 - back, opens);
}

@compute @workgroup_size(64)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= cell_count() {
        return;
    }
    let part = part_in_medium(cell_at(id.x));
    let share = share_of(part);
    let nearest = NEAREST * grid.low.w;
    var energy = vec3f(0.0);
    var flux = mat3x3f();
    for (var i = 0; i < 8; i++) {
        let point = part_point(part, i);
        let density = density_inside(point) * share;
        if density > 0.0 {
            for (var j = 0u; j < LIGHTS; j++) {
                let arrived = arrival(lights[j], point);
                if any(arrived.irradiance > vec3f(0.0)) {
                    let squared = arrived.distance * arrived.distance;
                    let bounded_share = select(1.0, squared / max(squared, nearest * nearest), arrived.distance > 0.0);
                    let lit = lit_share(lights[j], point, vec3f(0.0), arrived.direction);
                    let passed = lit * passed_share(point, arrived);
                    let scattered = arrived.irradiance * passed * (bounded_share * density);
                    energy += scattered;
                    for (var c = 0u; c < 3u; c++) {
                        flux[c] -= scattered[c] * arrived.direction;
                    }
                }
            }
        }
    }
    let volume = grid.low.w * grid.low.w * grid.low.w;
    let power = medium.scattering.rgb * (volume / 8.0);
    let within = media[3u * id.x].rgb;
    let of_emitted = scattered_of_emitted(id.x, media[3u * id.x].w);
    let goes_in = sent_in(id.x, within);
    var again = vec3f(0.0);
    for (var c = 0u; c < 3u; c++) {
        let all = energy[c] * power[c] + of_emitted[c];
        state[lobe_index(UNSCATTERED, c, id.x)] = lobe(flux[c] * (power[c] * medium.scattering.w), all);
        for (var light = 0u; light < KINDS; light++) {
            let collides = colliding(state[lobe_index(light, c, id.x)], within, c);
            again[c] += select(collides * goes_in[c], collides, light == UNSCATTERED);
        }
    }
    state[again_index(id.x)] = vec4f(again * media[3u * id.x + 1u].rgb, 0.0);
}
