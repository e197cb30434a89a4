// How light is spread over directions: render/src/lpv/lobe.rs.

const ROOT = 1.7320508;

// `v` and, last, `p` of `(p + v . w)^2`, from flux and energy.
fn lobe(flux: vec3f, all: f32) -> vec4f {
    let energy = max(all, 0.0);
    let size = length(flux);
    let directed = min(ROOT * size, energy);
    let p = 0.5 * (sqrt(energy + directed) + sqrt(energy - directed));
    let kept = directed / max(ROOT * size, 1e-30);
    return vec4f(flux * (1.5 * kept / max(p, 1e-30)), p);
}

fn lobe_energy(lobe: vec4f) -> f32 {
    return lobe.w * lobe.w + dot(lobe.xyz, lobe.xyz) / 3.0;
}

fn lobe_flux(lobe: vec4f) -> vec3f {
    return lobe.xyz * (lobe.w * (2.0 / 3.0));
}

// Energy along a direction, over its share of all directions.
fn towards(lobe: vec4f, direction: vec3f) -> f32 {
    let root = lobe.w + dot(lobe.xyz, direction);
    return root * root;
}
