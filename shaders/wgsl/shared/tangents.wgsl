// The frame whose z is a normal (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
fn tangents(normal: vec3f) -> mat3x3f {
    let sign = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    return mat3x3f(
        vec3f(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        vec3f(b, sign + normal.y * normal.y * a, -normal.y),
        normal,
    );
}
