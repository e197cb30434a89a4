// The medium as light propagation sees it: with a phase function that is the same for all directions, and as
// much less of it as keeps the mean flux (similarity: van de Hulst 1980). What is scattered nearly ahead
// counts then as not scattered; where light is wanted that was not, all of the medium is there (SIMILAR is
// 0).

#constant SIMILAR = 1

fn reduction() -> f32 {
    return select(0.0, medium.scattering.w, SIMILAR == 1u);
}

fn reduced_extinction() -> vec3f {
    return medium.extinction.rgb - reduction() * medium.scattering.rgb;
}

// What is scattered of a collision.
fn reduced_albedo() -> vec3f {
    let scattered = medium.scattering.rgb * (1.0 - reduction());
    return clamp(scattered / max(reduced_extinction(), vec3f(1e-30)), vec3f(0.0), vec3f(1.0));
}
