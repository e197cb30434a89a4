// GGX microfacets with Schlick's Fresnel (glTF 2.0, appendix B; render/src/path/bsdf/ggx.rs, fresnel.rs).

// The grazing reflectance is 1 for specular colours from here on.
const FULL_GRAZING = 0.02;
const INVERSE_PI = 0.31830989;

struct Fresnel {
    // Reflectance at normal incidence.
    normal: vec3f,
    // What grazing incidence adds.
    added: vec3f,
}

fn fresnel_of(specular: vec3f) -> Fresnel {
    let largest = max(specular.x, max(specular.y, specular.z));
    return Fresnel(specular, max(vec3f(min(largest / FULL_GRAZING, 1.0)) - specular, vec3f(0.0)));
}

// By the cosine to the facet.
fn fresnel_at(fresnel: Fresnel, cosine: f32) -> vec3f {
    let off = clamp(1.0 - cosine, 0.0, 1.0);
    return fresnel.normal + fresnel.added * (off * off) * (off * off) * off;
}

// Smith's lambda, by the cosine of a direction to the normal.
fn hidden_facets(cosine: f32, alpha: f32) -> f32 {
    return 0.5 * (sqrt(1.0 + alpha * alpha * max(1.0 / (cosine * cosine) - 1.0, 0.0)) - 1.0);
}

// Area of the microfacets at an angle to the normal, per area and steradian.
fn facet_density(alpha: f32, cosine: f32, squared_sine: f32) -> f32 {
    let all = squared_sine / (alpha * alpha) + cosine * cosine;
    return INVERSE_PI / (alpha * alpha * all * all);
}
