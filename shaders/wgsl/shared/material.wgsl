// What a material says of a point, as render/src/scene/material.rs has it.

#import uniforms/material_record

const GLOSS_PHONG = 1.0;
const GLOSS_NONE = 2.0;

struct Reflectance {
    diffuse: vec3f,
    specular: vec3f,
}

// From base colour and metalness at the point; `material.gloss_path.x` says how what is specular spreads.
fn reflectance(material: MaterialRecord, base: vec3f, metallic: f32) -> Reflectance {
    let body = base * (1.0 - metallic);
    let coat = mix(vec3f(material.factors.w), base, metallic);
    let gloss = material.gloss_path.x;
    if gloss == GLOSS_NONE {
        return Reflectance(body, vec3f(0.0));
    }
    if gloss != GLOSS_PHONG {
        return Reflectance(body, coat);
    }
    if material.specular.w == 0.0 {
        return Reflectance(min(body, 1.0 - coat), coat);
    }
    return Reflectance(min(base, 1.0 - material.specular.rgb), material.specular.rgb);
}
