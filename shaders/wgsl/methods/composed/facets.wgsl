// Puts light that microfacets reflect in place of Phong's: the share of the lamps' light that reaches a
// surface is what the g-buffer has over what there were if nothing hid it.

#import uniforms/frame_view
#constant OBJECTS = 1

@group(0) @binding(0) var<uniform> view: FrameView;
// [4, 3, height, width], as lobes.wgsl has them
@group(0) @binding(1) var<storage, read> lobes: array<f32>;
// [3, height, width] each
@group(0) @binding(2) var<storage, read> light_planes: array<f32>;
@group(0) @binding(3) var<storage, read> diffuse_planes: array<f32>;
@group(0) @binding(4) var<storage, read> specular_planes: array<f32>;
// [height, width]
@group(0) @binding(5) var<storage, read> object_plane: array<f32>;
// 1 for objects of microfacets
@group(0) @binding(6) var<storage, read> of_microfacets: array<u32>;
// [3, height, width]
@group(0) @binding(7) var<storage, read_write> image: array<f32>;

const LEAST = 1e-12;

@compute @workgroup_size(TILE, TILE)
fn reflect_by_facets(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= view.width || id.y >= view.height {
        return;
    }
    let pixels = view.width * view.height;
    let at = id.y * view.width + id.x;
    if of_microfacets[min(u32(object_plane[at]), OBJECTS - 1u)] == 0u {
        return;
    }
    for (var c = 0u; c < 3u; c++) {
        let here = at + c * pixels;
        let diffuse = diffuse_planes[here];
        let phong = diffuse * lobes[here] + specular_planes[here] * lobes[here + 3u * pixels];
        let light = light_planes[here];
        // Beside a highlight of metal Phong's model has nothing to compare with: nothing hides the lamp then.
        if phong > LEAST || light <= LEAST {
            let share = select(1.0, min(light / max(phong, LEAST), 1.0), phong > LEAST);
            let reflected = diffuse * lobes[here + 6u * pixels] + lobes[here + 9u * pixels];
            image[here] += share * reflected - light;
        }
    }
}
