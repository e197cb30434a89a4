// The width of Phong's lobe on a surface (render/src/path/bsdf/phong.rs).

// Smoother surfaces have the lobe of this squared roughness.
const NARROWEST_ALPHA = 0.02;

// Squared roughness.
fn phong_alpha(roughness: f32) -> f32 {
    return max(roughness * roughness, NARROWEST_ALPHA);
}

// The exponent of the lobe that is as wide as microfacets of a squared roughness.
fn phong_exponent(alpha: f32) -> f32 {
    return max(2.0 / (alpha * alpha) - 2.0, 0.0);
}
