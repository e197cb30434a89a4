/// A material: `render/src/scene/material.rs`.
struct MaterialRecord {
    /// Base colour and alpha.
    base: vec4f,
    /// Metalness, roughness, the alpha below which nothing is there, what it reflects as a dielectric at
    /// normal incidence.
    factors: vec4f,
    /// Emitted radiance; scale of the normal map, 0 without one.
    emission: vec4f,
    /// Specular colour; 1 where the material says one.
    specular: vec4f,
    /// How what is specular spreads (0 microfacets, 1 Phong, 2 not at all); mean free path, metres.
    gloss_path: vec4f,
    /// Columns of the transform of the base colour's coordinates.
    base_linear: vec4f,
    /// Its translation, the set of coordinates, nothing.
    base_rest: vec4f,
    /// As of the base colour, of metalness and roughness.
    gloss_linear: vec4f,
    /// As of the base colour, of metalness and roughness.
    gloss_rest: vec4f,
    /// As of the base colour, of the normal map.
    normal_linear: vec4f,
    /// As of the base colour, of the normal map.
    normal_rest: vec4f,
    /// As of the base colour, of emission.
    emission_linear: vec4f,
    /// As of the base colour, of emission.
    emission_rest: vec4f,
}
