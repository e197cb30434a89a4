// One iteration of propagation (Billeter et al. 2012, equation 3): each cell gathers what its 26 neighbours
// send to it, after what blocks and what the medium does on the way. The plain version is
// render/src/lpv/propagation.rs.

#import shared/lpv_flight
#import shared/lpv_grid
#import shared/lpv_kinds
#import shared/lpv_lattice
#import shared/lpv_lobe
#import shared/lpv_medium
#import shared/lpv_reflectance
#import uniforms/light_grid
#import uniforms/medium_record
#constant BORDERS = 1
#constant FACTORS = 0
#constant LOBES = 0
#constant NESTED = 1
#constant REFLECTS = 1
#constant SCATTERED = 1
#constant SHOWS = 1
#constant STEADY = 1
#constant UNSCATTERED = 2

/// How far light is propagated.
struct Propagation {
    /// Metres.
    reach: f32,
}

/// One iteration of propagation.
struct Iteration {
    /// Its number, from 0.
    number: u32,
}

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> medium: MediumRecord;
// [cells, 4]: as links.wgsl writes it
@group(0) @binding(2) var<storage, read> links: array<vec4u>;
// [cells, 3]: as media.wgsl writes it
@group(0) @binding(3) var<storage, read> media: array<vec4f>;
// [kinds, 3, cells]: lobes; then, if there is scattered light, [cells]
@group(0) @binding(4) var<storage, read> before: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> state: array<vec4f>;
// [1 + SCATTERED, 3, cells]: flux and energy times lengths of ways, watts times cells, as the medium and as
// surfaces show it
@group(0) @binding(6) var<storage, read_write> shown: array<vec4f>;
@group(0) @binding(7) var<uniform> iteration: Iteration;
@group(0) @binding(8) var<uniform> propagation: Propagation;
// [sides, 3, cells]: flux and energy that each iteration adds to light that is STEADY
@group(0) @binding(9) var<storage, read> source: array<vec4f>;
// [kinds]: by how much to multiply what is shown: 1, but for the last iteration
@group(0) @binding(10) var<storage, read> weights: array<vec4f>;

// Mean length of the way in the cell of light that sets out from it.
fn track_out(within: vec3f, extinction: vec3f) -> vec3f {
    if FACTORS != PLACED {
        return track(mean_leaving(within), extinction, dot(COUNTS * SHARES, DISTANCES));
    }
    var sum = vec3f(0.0);
    for (var kind = 0u; kind < 3u; kind++) {
        sum += COUNTS[kind] * SHARES[kind] * half_track(leaving(within, kind), extinction, kind);
    }
    return sum;
}

fn passing(link: u32, cell: u32) -> f32 {
    return f32((links[cell][link / 4u] >> (8u * (link % 4u))) & 255u) / 255.0;
}

fn lobes(light: u32, cell: u32) -> mat3x4f {
    return mat3x4f(
        before[lobe_index(light, 0u, cell)],
        before[lobe_index(light, 1u, cell)],
        before[lobe_index(light, 2u, cell)],
    );
}

// What a cell sends of light of such lobes.
fn sent(own: mat3x4f, direction: vec3f, kind: u32) -> vec3f {
    return vec3f(
        towards(own[0], direction, kind),
        towards(own[1], direction, kind),
        towards(own[2], direction, kind),
    );
}

// Flux and energy of the three colours.
struct Sums {
    flux: mat3x3f,
    energy: vec3f,
}

fn together(a: Sums, b: Sums) -> Sums {
    return Sums(a.flux + b.flux, a.energy + b.energy);
}

fn added(sums: Sums, energy: vec3f, direction: vec3f) -> Sums {
    let flux = mat3x3f(direction * energy.r, direction * energy.g, direction * energy.b);
    return Sums(sums.flux + flux, sums.energy + energy);
}

// Mean cosine of light that a matte surface sends.
const MATTE = 2.0 / 3.0;

alias Seen = array<Sums, 2>;

// Adds light of a kind to what the medium and surfaces show of it.
fn show(seen: ptr<function, Seen>, light: u32, energy: vec3f, direction: vec3f) {
    show_sums(seen, light, added(Sums(), energy, direction));
}

fn show_sums(seen: ptr<function, Seen>, light: u32, sums: Sums) {
    let weight = weights[light].rgb;
    let flux = mat3x3f(weight.r * sums.flux[0], weight.g * sums.flux[1], weight.b * sums.flux[2]);
    let weighed = Sums(flux, weight * sums.energy);
    if STEADY == 1u || light + 1u >= UNSCATTERED {
        seen[0] = together(seen[0], weighed);
    }
    if light == UNSCATTERED {
        seen[1] = together(seen[1], weighed);
    }
}

@compute @workgroup_size(64)
fn propagate(@builtin(global_invocation_id) id: vec3u) {
    let cell = id.x;
    let cells = cell_count();
    if cell >= cells {
        return;
    }
    let at = cell_at(cell);
    let own = media[3u * cell];
    let extinction = reduced_extinction() * own.w * grid.low.w;
    let albedo = reduced_albedo();
    // Iterations beyond the reach take nothing on.
    let on = select(0.0, 1.0, f32(iteration.number) * grid.low.w < propagation.reach);
    var enters: array<vec3f, 3>;
    for (var kind = 0u; kind < 3u; kind++) {
        enters[kind] = entering(own.rgb, extinction, kind);
    }
    let out = track_out(own.rgb, extinction) * on;
    var own_lobes: array<mat3x4f, KINDS>;
    var arrived: array<Sums, KINDS>;
    var seen: Seen;
    for (var light = 0u; light < KINDS; light++) {
        own_lobes[light] = lobes(light, cell);
        var leaves = Sums();
        for (var c = 0u; c < 3u; c++) {
            let own = moments(own_lobes[light][c]) * out[c];
            leaves.flux[c] = own.xyz;
            leaves.energy[c] = own.w;
        }
        show_sums(&seen, light, leaves);
    }
    var own_again = vec3f(0.0);
    if SCATTERED == 1u {
        own_again = before[again_index(cell)].rgb;
        if FACTORS == PLACED {
            show(&seen, UNSCATTERED, own_again * out, vec3f(0.0));
        }
    }
    let colour = reflectance(cell);
    let turns = half_space(albedo);
    for (var number = 0u; number < 27u; number++) {
        let offset = neighbour(number);
        let there = at - offset;
        if number == LINKS || !is_cell(there) {
            continue;
        }
        let source = cell_index(there);
        var passes = on;
        if number < LINKS {
            passes *= passing(LINKS - 1u - number, cell);
        } else {
            passes *= passing(number - LINKS - 1u, source);
        }
        let kind = kind_of(offset);
        let direction = normalize(vec3f(offset));
        let kept = direction * kept_direction(kind);
        let other = media[3u * source];
        let within = other.rgb;
        let share = SHARES[kind] * passes;
        let leaves_there = leaving(within, kind);
        let streams = share * leaves_there;
        var goes_in = vec3f(1.0);
        var goes_out = vec3f(1.0);
        if BORDERS == 1u {
            let there_even = leaves_there * media[3u * source + 2u].rgb;
            let own_even = leaving(own.rgb, kind) * media[3u * cell + 2u].rgb;
            let there_extinction = reduced_extinction() * other.w * grid.low.w;
            goes_in = max(let_in(there_even, own_even), enters[kind]);
            goes_out = max(let_in(own_even, there_even), entering(within, there_extinction, kind));
        }
        let way = half_track(enters[kind], extinction, kind);
        var collides = vec3f(0.0);
        for (var light = 0u; light < KINDS; light++) {
            var energy = streams * sent(lobes(light, source), direction, kind);
            if light == UNSCATTERED {
                energy += share * leaving_again(within, kind) * before[again_index(source)].rgb;
            }
            arrived[light] = added(arrived[light], energy * enters[kind], kept);
            collides += energy;
            show(&seen, light, energy * way, kept);
        }
        if SCATTERED == 1u {
            arrived[KINDS - 1u].energy += collides * albedo * max(goes_in - enters[kind], vec3f(0.0));
        }
        if REFLECTS == 1u {
            // What the cell itself sends there and surfaces on the way reflect comes back half a way later.
            let leaves = leaving(own.rgb, kind);
            let returns = (SHARES[kind] * (on - passes)) * colour;
            let back = half_track(leaves, extinction, kind);
            collides = vec3f(0.0);
            var sets_out = vec3f(0.0);
            for (var light = 0u; light < KINDS; light++) {
                var energy = leaves * sent(own_lobes[light], -direction, kind);
                if light == UNSCATTERED {
                    energy += leaving_again(own.rgb, kind) * own_again;
                }
                sets_out += energy;
                energy *= returns;
                let becomes = select(light, light + 1u, light + 1u < UNSCATTERED);
                arrived[becomes] = added(arrived[becomes], energy * leaves, MATTE * direction);
                collides += energy;
                show(&seen, becomes, energy * back, MATTE * direction);
            }
            if SCATTERED == 1u {
                arrived[KINDS - 1u].energy += collides * albedo * (1.0 - leaves);
            }
            if BORDERS == 1u {
                // What a denser medium there turns back comes as if from there.
                let turned = share * sets_out * turns * (1.0 - goes_out);
                arrived[KINDS - 1u] = added(arrived[KINDS - 1u], turned * enters[kind], kept);
                arrived[KINDS - 1u].energy += turned * albedo * (1.0 - enters[kind]);
                show(&seen, UNSCATTERED, turned * way, kept);
            }
        }
    }
    var again = vec3f(0.0);
    for (var light = 0u; light < KINDS; light++) {
        for (var c = 0u; c < 3u; c++) {
            var all = vec4f(arrived[light].flux[c], arrived[light].energy[c]);
            if NESTED == 1u && is_border(at) {
                // What goes on from here is the coarser grid's.
                all = vec4f(0.0);
            }
            if STEADY == 1u {
                all += source[lobe_index(light, c, cell)];
            }
            let made = lobe(all.xyz, all.w);
            state[lobe_index(light, c, cell)] = made;
            if SCATTERED == 1u {
                again[c] += colliding(made, own.rgb, c);
            }
        }
    }
    if SCATTERED == 1u {
        state[again_index(cell)] = vec4f(again * media[3u * cell + 1u].rgb, 0.0);
    }
    // Of steady light the last iteration shows all.
    if SHOWS == 1u {
        for (var plane = 0u; plane <= SCATTERED; plane++) {
            for (var c = 0u; c < 3u; c++) {
                shown[(3u * plane + c) * cells + cell] += vec4f(seen[plane].flux[c], seen[plane].energy[c]);
            }
        }
    }
}
