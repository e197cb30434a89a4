// One iteration of propagation (Billeter et al. 2012, equation 3): each cell gathers what its 26 neighbours send to it,
// after what blocks and what the medium does on the way. The plain version is render/src/lpv/propagation.rs.

@group(0) @binding(0) var<uniform> grid: LightGrid;
@group(0) @binding(1) var<uniform> medium: MediumRecord;
// [cells, 4]: as links.wgsl writes it
@group(0) @binding(2) var<storage, read> links: array<vec4u>;
// [cells, 2]: as media.wgsl writes it
@group(0) @binding(3) var<storage, read> media: array<vec4f>;
// [fields, 3, cells]: lobes of light that met no medium, then of light that was scattered
@group(0) @binding(4) var<storage, read> state: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> next: array<vec4f>;
// [3, cells]: flux and energy times lengths of ways, watts times cells
@group(0) @binding(6) var<storage, read_write> shown: array<vec4f>;
@group(0) @binding(7) var<uniform> iteration: Iteration;
@group(0) @binding(8) var<uniform> propagation: Propagation;

// Mean cosine of light that a matte surface sends.
const DIRECTED = 2.0 / 3.0;
// Less extinction than this per cell counts as none where lengths are asked for.
const CLEAR = 1e-3;

// Length of half a way on which so much passes.
fn track(passes: vec3f, extinction: vec3f, distance: f32) -> vec3f {
    return select(vec3f(0.5 * distance), (1.0 - passes) / max(extinction, vec3f(CLEAR)), extinction > vec3f(CLEAR));
}

fn passing(link: u32, cell: u32) -> f32 {
    return f32((links[cell][link / 4u] >> (8u * (link % 4u))) & 255u) / 255.0;
}

// What surfaces around a cell reflect.
fn reflectance(cell: u32) -> vec3f {
    return vec3f((vec3u(links[cell].w) >> vec3u(8u, 16u, 24u)) & vec3u(255u)) / 255.0;
}

fn energies(light: mat3x4f) -> vec3f {
    return vec3f(lobe_energy(light[0]), lobe_energy(light[1]), lobe_energy(light[2]));
}

fn sent(light: mat3x4f, direction: vec3f) -> vec3f {
    return vec3f(towards(light[0], direction), towards(light[1], direction), towards(light[2], direction));
}

fn lobes(field: u32, cell: u32) -> mat3x4f {
    let cells = cell_count();
    let first = 3u * field * cells + cell;
    return mat3x4f(state[first], state[first + cells], state[first + 2u * cells]);
}

@compute @workgroup_size(64)
fn propagate(@builtin(global_invocation_id) id: vec3u) {
    let cell = id.x;
    let cells = cell_count();
    if cell >= cells {
        return;
    }
    let at = cell_at(cell);
    let own = media[2u * cell];
    let extinction = reduced_extinction() * own.w * grid.low.w;
    let albedo = reduced_albedo();
    var enters: array<vec3f, 3>;
    var track_out = vec3f(0.0);
    for (var kind = 0u; kind < 3u; kind++) {
        enters[kind] = exp(-(extinction - own.rgb) * DISTANCES[kind]);
        let leaves = exp(-own.rgb * DISTANCES[kind]);
        track_out += COUNTS[kind] * SHARES[kind] * track(leaves, extinction, DISTANCES[kind]);
    }
    // Iterations beyond the reach take nothing on.
    let on = select(0.0, 1.0, f32(iteration.number) * grid.low.w < propagation.reach);
    // Of light that met no medium, of scattered light, and of what is shown.
    var energy: array<vec3f, 3>;
    var flux: array<mat3x3f, 3>;
    let seen = lobes(SHOWN, cell);
    energy[2] = energies(seen);
    if SHOWN == 1u {
        energy[2] += media[2u * cell + 1u].rgb * (energy[2] + energies(lobes(0u, cell)));
    }
    track_out *= on;
    energy[2] *= track_out;
    for (var c = 0u; c < 3u; c++) {
        flux[2][c] = lobe_flux(seen[c]) * track_out[c];
    }
    let colour = reflectance(cell);
    let own_fresh = lobes(0u, cell);
    let own_scattered = lobes(MULTIPLE, cell);
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
        let share = SHARES[kind] * passes * exp(-media[2u * source].rgb * DISTANCES[kind]);
        let fresh = lobes(0u, source);
        let first = share * sent(fresh, direction);
        let length = track(enters[kind], extinction, DISTANCES[kind]);
        energy[0] += first * enters[kind];
        var arrived = first;
        if MULTIPLE == 1u {
            let scattered = lobes(1u, source);
            let again = media[2u * source + 1u].rgb * (energies(fresh) + energies(scattered));
            let second = share * (sent(scattered, direction) + again);
            energy[1] += second * enters[kind] + (first + second) * (albedo * (1.0 - enters[kind]));
            for (var c = 0u; c < 3u; c++) {
                flux[1][c] += direction * (second[c] * enters[kind][c]);
            }
            arrived = select(first, second, SHOWN == 1u);
        }
        energy[2] += arrived * length;
        for (var c = 0u; c < 3u; c++) {
            flux[0][c] += direction * (first[c] * enters[kind][c]);
            flux[2][c] += direction * (arrived[c] * length[c]);
        }
        // What the cell itself sends there and surfaces on the way reflect comes back half a way later.
        if MULTIPLE == 1u {
            let out = exp(-own.rgb * DISTANCES[kind]);
            let returns = (SHARES[kind] * (on - passes)) * colour * out;
            let back = returns * sent(own_fresh, -direction);
            let own_again = media[2u * cell + 1u].rgb * (energies(own_fresh) + energies(own_scattered));
            let back_again = returns * (sent(own_scattered, -direction) + own_again);
            let way = track(out, extinction, DISTANCES[kind]);
            energy[0] += back * out;
            energy[1] += back_again * out + (back + back_again) * (albedo * (1.0 - out));
            let shown_back = select(back, back_again, SHOWN == 1u) * way;
            energy[2] += shown_back;
            for (var c = 0u; c < 3u; c++) {
                flux[0][c] += (DIRECTED * back[c] * out[c]) * direction;
                flux[1][c] += (DIRECTED * back_again[c] * out[c]) * direction;
                flux[2][c] += (DIRECTED * shown_back[c]) * direction;
            }
        }
    }
    for (var c = 0u; c < 3u; c++) {
        next[c * cells + cell] = lobe(flux[0][c], energy[0][c]);
        if MULTIPLE == 1u {
            next[(3u + c) * cells + cell] = lobe(flux[1][c], energy[1][c]);
        }
        shown[c * cells + cell] += vec4f(flux[2][c], energy[2][c]);
    }
}
