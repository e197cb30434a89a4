// States moved on, a share of each with what rounding leaves of its changes. Passes bind `paints`, `time` and
// `states`, [2, .., STATES]: shares, and then what rounding has left.

#import shared/glow_time
#constant EULER = 0
#constant FIRST_PIECE = 0
#constant PIECES = 1
#constant PIECES_AT_ONCE = 1
#constant SCHEDULES = 1
#constant STATES = 1

// Light before the beginning, which is an equilibrium by any scheme.
const FOR_LONG = 1e12;

struct Share {
    value: f32,
    left: f32,
}

// A share and a change, with what rounding leaves (Kahan 1965): the changes of slow states in a frame are
// smaller than what can be told from their shares. `nothing` is 0, which compilers do not know: they would
// take (a + b) - a for b.
fn changed(share: Share, change: f32, nothing: u32) -> Share {
    let wanted = change + share.left;
    let sum = bitcast<f32>(bitcast<u32>(share.value + wanted) ^ nothing);
    let value = clamp(sum, 0.0, 1.0);
    return Share(value, select(0.0, wanted - (sum - share.value), value == sum));
}

// One exact step of the rate equation (thesis, equation 8.1). What is left after a long time is less than
// what rounding leaves of the change, so that it is found by itself.
fn exactly(share: Share, charge: f32, decay: f32, seconds: f32, nothing: u32) -> Share {
    let rate = charge + decay;
    if rate <= 0.0 {
        return share;
    }
    let rest = charge / rate;
    let x = exponent(rate, seconds);
    if x > 0.5 {
        return Share(clamp(rest + (share.value - rest) * exp(-x), 0.0, 1.0), 0.0);
    }
    return changed(share, (rest - share.value) * progress(x), nothing);
}

// The states of a texel, a cell or a patch after a stretch of time, under light of each schedule: exactly, or
// by EULER steps of Euler's scheme for each time in which no lamp is switched. Of these times a dispatch goes
// through PIECES_AT_ONCE, from FIRST_PIECE on: an invocation may take so many turns of its loops, and no
// more. `factors` are what it has of the paint's rates.
fn move_on(
    kept: u32,
    paint: u32,
    factors: vec4f,
    irradiance: ptr<function, array<vec3f, SCHEDULES>>,
    nothing: u32,
) {
    let anew = time[0] == 1.0 && FIRST_PIECE == 0u;
    for (var s = 0u; s < STATES; s++) {
        var state = paints[paint * STATES + s];
        state.rates *= factors;
        let at = kept * STATES + s;
        let at_left = at + arrayLength(&states) / 2u;
        var share = Share(states[at], states[at_left]);
        if anew {
            share = Share(state.emission.w, 0.0);
        }
        for (var piece = FIRST_PIECE; piece < min(FIRST_PIECE + PIECES_AT_ONCE, PIECES); piece++) {
            let start = piece_start(piece);
            // Behind the last piece no time passes.
            if time[start] <= 0.0 {
                break;
            }
            var light = vec3f(0.0);
            for (var schedule = 0u; schedule < SCHEDULES; schedule++) {
                light += select(vec3f(0.0), (*irradiance)[schedule], time[start + 1u + schedule] == 1.0);
            }
            let charge = charge_of(state, light);
            if EULER == 0u || time[start] >= FOR_LONG {
                share = exactly(share, charge, state.rates.w, time[start], nothing);
                continue;
            }
            let seconds = time[start] / f32(EULER);
            for (var i = 0u; i < EULER; i++) {
                let slope = (1.0 - share.value) * charge - share.value * state.rates.w;
                share = changed(share, seconds * slope, nothing);
            }
        }
        states[at] = share.value;
        states[at_left] = share.left;
    }
}
