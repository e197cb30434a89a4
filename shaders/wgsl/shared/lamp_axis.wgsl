// Where a lamp is as the eye sees it: half-planes through that line hold view rays and light rays alike
// (Baran et al. 2010, section 3). Passes bind `lights`, `view`, and of which lamp they are.

#import uniforms/of_lamp

const DISTANT = 2.0;

@group(0) @binding(13) var<uniform> of_lamp: OfLamp;

struct Axis {
    // Unit direction from the eye to the lamp, world space.
    direction: vec3f,
    // How far away it is, metres; negative if infinitely far.
    reach: f32,
}

fn lamp_axis() -> Axis {
    let light = lights[of_lamp.number];
    if light.place.w == DISTANT {
        return Axis(-light.axis.xyz, -1.0);
    }
    let offset = light.place.xyz - view.eye.xyz;
    let reach = max(length(offset), 1e-20);
    return Axis(offset / reach, reach);
}
