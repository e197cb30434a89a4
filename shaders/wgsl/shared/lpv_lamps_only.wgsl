// Where no surface emits light, the medium scatters none of it.

fn scattered_of_emitted(cell: u32, density: f32) -> vec3f {
    return vec3f(0.0);
}
