// Coefficients of three colours; their mean where a medium is to be grey.
#constant GREY = 0

fn colours(coefficients: vec3f) -> vec3f {
    return select(coefficients, vec3f(dot(coefficients, vec3f(1.0 / 3.0))), GREY == 1u);
}
