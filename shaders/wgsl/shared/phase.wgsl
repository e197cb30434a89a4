// The phase function of Henyey and Greenstein 1941, 1/sr; `cosine` is of the angle between the ways before
// and after.
fn phase(cosine: f32) -> f32 {
    let g = medium.scattering.w;
    let squared = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (4.0 * PI * squared * sqrt(squared));
}
