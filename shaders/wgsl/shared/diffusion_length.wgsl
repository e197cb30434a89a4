// The length of the profile for light that enters evenly below a surface of a colour: the mean free path over
// 1.9 - A + 3.5 (A - 0.8)^2 (Christensen and Burley 2015, equation 6).
fn diffusion_length(mean_free_path: f32, colour: f32) -> f32 {
    return max(mean_free_path, 0.0) / (1.9 - colour + 3.5 * (colour - 0.8) * (colour - 0.8));
}
