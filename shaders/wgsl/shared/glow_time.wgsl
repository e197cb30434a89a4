// A stretch of time, and what it does to states: render/src/scene/glow.rs, glow/src/paint.rs. `time` is
// whether states begin anew (1), for each lamp its schedule, and PIECES times how long no lamp is switched,
// seconds, and for each schedule whether its lamps are on (1).

#import uniforms/paint_state
#constant LIGHTS = 1
#constant SCHEDULES = 1

// Rates above this are taken for this.
const FASTEST = 1e30;

fn schedule_of(light: u32) -> u32 {
    return u32(time[1u + light]);
}

fn piece_start(piece: u32) -> u32 {
    return 1u + LIGHTS + piece * (1u + SCHEDULES);
}

// The rate at which light excites a state; what is no amount of light is none. A colour that does not excite
// does nothing, even where its light is endless.
fn charge_of(state: PaintState, irradiance: vec3f) -> f32 {
    let rates = state.rates.rgb;
    let lit = select(vec3f(0.0), rates * irradiance, irradiance > vec3f(0.0));
    let charges = select(vec3f(0.0), lit, rates > vec3f(0.0));
    return min(charges.r + charges.g + charges.b, FASTEST);
}

// Rate times time, where it matters: nothing is left of what decays by more.
fn exponent(rate: f32, seconds: f32) -> f32 {
    return select(rate * seconds, 80.0, rate > 80.0 / max(seconds, 1e-30));
}

// How much of the way to the equilibrium a time goes: 1 - exp(-x), without loss where x is small.
fn progress(x: f32) -> f32 {
    if x < 0.02 {
        return x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)));
    }
    return 1.0 - exp(-x);
}
