// Phosphorescence as an integral over the past (Glassner 1995), at each pixel: moments drawn by the decay,
// and at each of them the light of the lamps that shone then. The plain version is
// render/src/methods/phosphor/glassner.rs.

#import shared/bounded
#import shared/glow_place
#import shared/glow_tile
#import shared/glow_time
#import shared/random
#import uniforms/frame_view
#import uniforms/glow_tile
#import uniforms/light_record
#import uniforms/paint_state
#constant LIGHTS = 1
#constant PAINT_STATES = 1
#constant PIECES = 1
#constant STATES = 1

/// A stretch of the past in `methods/phosphor/glassner`.
struct GlowStretch {
    /// From how many seconds ago on.
    since: f32,
    /// Up to how many.
    until: f32,
    /// Whether what it gives is added to the image (1).
    adds: u32,
    /// The first of the samples that are drawn.
    first: u32,
    /// How many are drawn.
    count: u32,
}

/// What `methods/phosphor/glassner` reads.
struct GlowSamples {
    /// Columns of the image.
    width: u32,
    /// Rows of the image.
    height: u32,
    /// Moments that are drawn of each state.
    samples: u32,
    /// Chooses them.
    seed: u32,
}

@group(0) @binding(0) var<uniform> settings: GlowSamples;
@group(0) @binding(1) var<uniform> paints: array<PaintState, PAINT_STATES>;
@group(0) @binding(2) var<storage, read> tiles: array<GlowTile>;
@group(0) @binding(3) var<storage, read> posed: array<f32>;
@group(0) @binding(4) var<storage, read> found: array<vec4f>;
// All of the past, the oldest piece first.
@group(0) @binding(5) var<storage, read> time: array<f32>;
@group(0) @binding(6) var<storage, read> lights: array<LightRecord>;
@group(0) @binding(7) var<storage, read> map_views: array<FrameView>;
@group(0) @binding(8) var<storage, read> pictures: array<u32>;
@group(0) @binding(9) var maps: texture_depth_2d_array;
@group(0) @binding(10) var map_sampler: sampler_comparison;
// [3, height, width]
@group(0) @binding(13) var<storage, read_write> image: array<f32>;
// When the world was as vertices and maps have it.
@group(0) @binding(14) var<uniform> stretch: GlowStretch;

fn whole_past() -> f32 {
    var seconds = 0.0;
    for (var piece = 0u; piece < PIECES; piece++) {
        seconds += time[piece_start(piece)];
    }
    return seconds;
}

// The inverse of `progress`.
fn exponent_of(part: f32) -> f32 {
    if part < 0.02 {
        return part * (1.0 + part * (0.5 + part * (1.0 / 3.0 + part * 0.25)));
    }
    return -log(max(1.0 - part, 1e-37));
}

// The piece in which so many seconds ago was.
fn piece_at(ago: f32) -> u32 {
    var left = ago;
    var found_piece = 0u;
    var is_found = false;
    for (var i = 0u; i < PIECES; i++) {
        let piece = PIECES - 1u - i;
        let seconds = time[piece_start(piece)];
        if !is_found && left < seconds {
            found_piece = piece;
            is_found = true;
        }
        left -= seconds;
    }
    return found_piece;
}

fn irradiance_in(piece: u32, place: Place) -> vec3f {
    let start = piece_start(piece);
    var sum = vec3f(0.0);
    for (var i = 0u; i < LIGHTS; i++) {
        if time[start + 1u + schedule_of(i)] == 1.0 {
            sum += received(lights[i], place);
        }
    }
    return sum;
}

@compute @workgroup_size(TILE, TILE)
fn look_back(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= settings.width || id.y >= settings.height {
        return;
    }
    let pixels = settings.width * settings.height;
    let pixel = id.y * settings.width + id.x;
    let at = found[pixel];
    var sent = vec3f(0.0);
    if at.x > 0.0 {
        let tile = tiles[u32(at.x) - 1u];
        let place = place_of(tile_vertices(tile), vec3f(1.0 - at.y - at.z, at.yz));
        let past = whole_past();
        // Of all samples those of this dispatch.
        let samples = bounded(stretch.count, id.xy);
        for (var s = 0u; s < STATES; s++) {
            let state = paints[tile.paint * STATES + s];
            let decay = state.rates.w;
            // What does not decay is dark.
            if decay <= 0.0 {
                continue;
            }
            let within = progress(exponent(decay, past));
            var charges = 0.0;
            for (var i = 0u; i < samples; i++) {
                let number = random(id.xy, settings.seed, (i + stretch.first) * STATES + s);
                let ago = exponent_of(number * within) / decay;
                if ago >= stretch.since && ago < stretch.until {
                    charges += charge_of(state, irradiance_in(piece_at(ago), place));
                }
            }
            let at_first = state.emission.w * exp(-exponent(decay, past));
            let share = charges / f32(settings.samples) * within / decay + select(at_first, 0.0, stretch.adds == 1u);
            sent += state.emission.rgb * share;
        }
    }
    for (var c = 0u; c < 3u; c++) {
        let at_plane = pixel + c * pixels;
        image[at_plane] = sent[c] + select(0.0, image[at_plane], stretch.adds == 1u);
    }
}
