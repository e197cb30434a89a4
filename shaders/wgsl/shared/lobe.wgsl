// How what is seen at a pixel reflects light specularly to the eye: GGX microfacets with Schlick's Fresnel
// (glTF 2.0, appendix B). The plain version is render/src/methods/lobe.rs.

#import shared/facets

// Narrower lobes are below what directions resolve.
const NARROWEST_ALPHA = 1e-3;

struct Lobe {
    normal: vec3f,
    // Unit direction to the eye.
    viewer: vec3f,
    // Reflectance at normal incidence.
    specular: vec3f,
    // Slope of the microfacets.
    alpha: f32,
}

fn lobe_at(at: u32, position: vec3f, normal: vec3f) -> Lobe {
    let roughness = 1.0 - gloss[at].w;
    return Lobe(normal, normalize(-position), gloss[at].xyz, max(roughness * roughness, NARROWEST_ALPHA));
}

// Whether the eye is above it, which a normal that is bent may not be.
fn is_seen(lobe: Lobe) -> bool {
    return dot(lobe.normal, lobe.viewer) > 0.0;
}

// Whether it reflects anything to the eye.
fn shines(lobe: Lobe) -> bool {
    return is_seen(lobe) && any(lobe.specular > vec3f(0.0));
}

// Area of its microfacets with a normal, per area and steradian.
fn lobe_facets(lobe: Lobe, facet: vec3f) -> f32 {
    let cosine = dot(lobe.normal, facet);
    let off = facet - cosine * lobe.normal;
    return facet_density(lobe.alpha, cosine, dot(off, off));
}

// The facets that mirror a direction to the eye.
fn facet_between(lobe: Lobe, light: vec3f) -> vec3f {
    let between = lobe.viewer + light;
    return select(lobe.normal, normalize(between), dot(between, between) > 0.0);
}

fn fresnel(lobe: Lobe, facet: vec3f) -> vec3f {
    return fresnel_at(fresnel_of(lobe.specular), dot(lobe.viewer, facet));
}

// Density with which visible facets mirror the eye's direction into one, per steradian (Heitz 2018).
fn lobe_density(lobe: Lobe, light: vec3f) -> f32 {
    let to_viewer = dot(lobe.normal, lobe.viewer);
    let hidden = hidden_facets(to_viewer, lobe.alpha);
    return lobe_facets(lobe, facet_between(lobe, light)) / (4.0 * to_viewer * (1.0 + hidden));
}

// Share of what those facets mirror that no other facet stops; of a white surface, reflectance times the
// cosine of light's direction over that density.
fn lobe_visibility(lobe: Lobe, light: vec3f) -> f32 {
    let to_light = dot(lobe.normal, light);
    if to_light <= 0.0 {
        return 0.0;
    }
    let visible = 1.0 + hidden_facets(dot(lobe.normal, lobe.viewer), lobe.alpha);
    return visible / (visible + hidden_facets(to_light, lobe.alpha));
}
