// Mean of exp(-x) from 0 to a depth.
fn mean_decay(depth: vec3f) -> vec3f {
    let thin = 1.0 - depth * (0.5 - depth / 6.0);
    return select((1.0 - exp(-depth)) / max(depth, vec3f(1e-30)), thin, depth < vec3f(1e-2));
}
