// What the cells of a medium that keeps light send: render/src/methods/phosphor/cells.rs. Passes bind
// `paints`, `lattice` and `states`.

#constant PAINT = 0
#constant STATES = 1

// What the cells around a point send, trilinear between their middles.
fn sent_at(point: vec3f) -> vec3f {
    let at = (point - lattice.low.xyz) / (lattice.high.xyz - lattice.low.xyz) * lattice.cells.xyz - 0.5;
    let within = clamp(at, vec3f(0.0), lattice.cells.xyz - 1.0);
    let low = vec3u(within);
    let part = within - vec3f(low);
    let size = vec3u(lattice.cells.xyz);
    var sent = vec3f(0.0);
    for (var i = 0u; i < 8u; i++) {
        let corner = vec3u(i & 1u, (i >> 1u) & 1u, i >> 2u);
        let weights = select(1.0 - part, part, corner == vec3u(1u));
        let cell = min(low + corner, size - 1u);
        let first = ((cell.z * size.y + cell.y) * size.x + cell.x) * STATES;
        for (var s = 0u; s < STATES; s++) {
            let weight = weights.x * weights.y * weights.z * states[first + s];
            sent += weight * paints[PAINT * STATES + s].emission.rgb;
        }
    }
    return sent;
}
