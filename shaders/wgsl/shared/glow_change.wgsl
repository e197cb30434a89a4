// States moved on, a share of each with what rounding leaves of its changes. Passes bind `paints`, `time` and `states`, [2, ..,
// STATES]: shares, and then what rounding has left.

struct Share {
    value: f32,
    left: f32,
}

// A share and a change, with what rounding leaves (Kahan 1965): the changes of slow states in a frame are smaller than what can
// be told from their shares. `nothing` is 0, which compilers do not know: they would take (a + b) - a for b.
fn changed(share: Share, change: f32, nothing: u32) -> Share {
    let wanted = change + share.left;
    let sum = bitcast<f32>(bitcast<u32>(share.value + wanted) ^ nothing);
    let value = clamp(sum, 0.0, 1.0);
    return Share(value, select(0.0, wanted - (sum - share.value), value == sum));
}

// The states of a texel, a cell or a patch after a stretch of time, under light of each schedule.
fn move_on(kept: u32, paint: u32, irradiance: ptr<function, array<vec3f, SCHEDULES>>, nothing: u32) {
    let anew = time[0] == 1.0;
    for (var s = 0u; s < STATES; s++) {
        let state = paints[paint * STATES + s];
        let at = kept * STATES + s;
        let at_left = at + arrayLength(&states) / 2u;
        var share = Share(states[at], states[at_left]);
        if anew {
            share = Share(state.emission.w, 0.0);
        }
        for (var piece = 0u; piece < PIECES; piece++) {
            let start = piece_start(piece);
            // Behind the last piece no time passes.
            if time[start] <= 0.0 {
                break;
            }
            var light = vec3f(0.0);
            for (var schedule = 0u; schedule < SCHEDULES; schedule++) {
                light += select(vec3f(0.0), (*irradiance)[schedule], time[start + 1u + schedule] == 1.0);
            }
            share = changed(share, change_of(share.value, charge_of(state, light), state.rates.w, time[start]), nothing);
        }
        states[at] = share.value;
        states[at_left] = share.left;
    }
}
