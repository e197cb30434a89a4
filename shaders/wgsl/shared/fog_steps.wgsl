// Steps along a view ray, each of which looks into a lamp's shadow maps. The plain version is
// render/src/methods/fog_march/reference.rs.

#import shared/lights
#import shared/mean_decay
#import shared/medium
#import shared/single_scattering
#import uniforms/light_record

// Nearer to a lamp than this, metres, or than this part of its distance to the eye, it counts as that near:
// it is infinitely bright there.
const NEAREST = vec2f(1e-4, 1e-5);

// How a view ray is cut: at equal angles as seen from a lamp, which bring the same light each (Kulla and
// Fajardo 2012), or, of distant lamps, at equal distances.
struct Cut {
    first: f32,
    step: f32,
    // Where on the ray the lamp is nearest, and how near, metres; not positive of distant ones.
    nearest: f32,
    aside: f32,
}

fn cut_for(light: LightRecord, direction: vec3f, span: vec2f, steps: u32) -> Cut {
    if light.place.w == DIRECTIONAL {
        return Cut(span.x, (span.y - span.x) / f32(steps), 0.0, 0.0);
    }
    let offset = light.place.xyz - view.eye.xyz;
    let nearest = dot(offset, direction);
    let aside = max(length(offset - direction * nearest), max(NEAREST.x, NEAREST.y * length(offset)));
    let angles = atan((span - nearest) / aside);
    return Cut(angles.x, (angles.y - angles.x) / f32(steps), nearest, aside);
}

// The distance that is so many steps along.
fn cut_at(cut: Cut, steps: f32) -> f32 {
    let at = cut.first + steps * cut.step;
    return select(at, cut.nearest + cut.aside * tan(at), cut.aside > 0.0);
}

// The length that a step counts for which is lit at `at`: of steps of equal angle what cancels the inverse
// square there.
fn step_length(cut: Cut, begins: f32, at: f32, ends: f32) -> f32 {
    let tangent = (at - cut.nearest) / max(cut.aside, 1e-30);
    return select(ends - begins, cut.aside * cut.step * (1.0 + tangent * tangent), cut.aside > 0.0);
}

// Radiance of a ray from one lamp, over the scattering coefficient.
fn scattered_along(light: LightRecord, direction: vec3f, span: vec2f, steps: u32, shift: f32) -> vec3f {
    let cut = cut_for(light, direction, span, steps);
    let extinction = medium.extinction.rgb;
    var sum = vec3f(0.0);
    var before = 0.0;
    var begins = span.x;
    for (var i = 0u; i < steps; i++) {
        let ends = select(cut_at(cut, f32(i) + 1.0), span.y, i + 1u == steps);
        let at = clamp(cut_at(cut, f32(i) + shift), begins, ends);
        let point = view.eye.xyz + direction * at;
        let density = density_inside(point);
        let here = density * (ends - begins);
        if here > 0.0 {
            // What is left after the mean way within the step.
            let left = exp(-extinction * before) * mean_decay(extinction * here);
            let weight = left * density * step_length(cut, begins, at, ends);
            sum += weight * scattered_of(light, point, direction, cut.aside);
        }
        before += here;
        begins = ends;
    }
    return sum;
}
