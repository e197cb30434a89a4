// From textures of a renderer to the buffers that a network reads, and from a network's image to a texture.

/**
 * Writes the buffers `position`, `normal` and `valid` of a plan from what a rasteriser has: a depth texture
 * and a texture of normals in camera space. Camera space has x to the right, y up and z towards the camera.
 */
export class TextureReader {
  /**
   * `normals` says what the texture of normals holds: `unit`, components from -1 to 1, or `colour`, from 0 to
   * 1. `background` is the depth where nothing is seen: 1, or 0 with reversed depth.
   */
  constructor(plan, { normals = 'unit', background = 1 } = {}) {
    const { device } = plan.network;
    const [scale, offset] = normals === 'colour' ? [2, -1] : [1, 0];
    const numbers = { BACKGROUND: background, SCALE: scale, OFFSET: offset };
    const constants = Object.entries(numbers).map(
      ([name, value]) => `const ${name} = ${value.toFixed(1)};\n`,
    );
    this.plan = plan;
    this.uniform = device.createBuffer({ label: 'deepshade.reader', size: 80, usage: UNIFORM });
    this.pipeline = pipeline(device, 'deepshade.reader', constants.join('') + READER);
    // A network may read some of them alone.
    this.own = [];
    this.buffers = Object.entries({ position: 3, normal: 3, valid: 1 }).map(([name, planes]) => {
      return plan.buffers[name] ?? this.#made(name, 4 * planes * plan.width * plan.height);
    });
  }

  #made(name, size) {
    const buffer = this.plan.network.device.createBuffer({
      label: `deepshade.${name}`,
      size,
      usage: STORAGE,
    });
    this.own.push(buffer);
    return buffer;
  }

  /** Records it: two texture views, and 16 numbers, column after column. */
  encode(encoder, { depth, normal, inverseProjection }) {
    const { device } = this.plan.network;
    if (inverseProjection?.length !== 16) {
      throw new Error('deepshade: inverseProjection is missing; 16 numbers are wanted, column after column');
    }
    const told = new DataView(new ArrayBuffer(80));
    Array.from(inverseProjection).forEach((number, index) => told.setFloat32(4 * index, number, true));
    told.setUint32(64, this.plan.width, true);
    told.setUint32(68, this.plan.height, true);
    device.queue.writeBuffer(this.uniform, 0, told.buffer);
    const resources = [
      { buffer: this.uniform },
      depth,
      normal,
      ...this.buffers.map((buffer) => ({ buffer })),
    ];
    tiled(encoder, this.pipeline, bound(device, this.pipeline, resources), this.plan);
  }

  /** Frees what it made. */
  destroy() {
    [this.uniform, ...this.own].forEach((buffer) => buffer.destroy());
  }
}

/** A plan's image as a texture, `rgba16float`; one channel goes into red, green and blue. */
export class ImageTexture {
  constructor(plan) {
    const { device, description } = plan.network;
    this.plan = plan;
    this.texture = device.createTexture({
      label: 'deepshade.image',
      size: [plan.width, plan.height],
      format: 'rgba16float',
      usage: GPUTextureUsage.STORAGE_BINDING | GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_SRC,
    });
    const code = `const CHANNELS = ${description.channels}u;\n${WRITER}`;
    this.pipeline = pipeline(device, 'deepshade.writer', code);
    this.group = bound(device, this.pipeline, [{ buffer: plan.image }, this.texture.createView()]);
  }

  /** Records it. */
  encode(encoder) {
    tiled(encoder, this.pipeline, this.group, this.plan);
  }

  /** Frees the texture. */
  destroy() {
    this.texture.destroy();
  }
}

const STORAGE = 0x80;
const UNIFORM = 0x48; // UNIFORM and COPY_DST

const pipeline = (device, label, code) =>
  device.createComputePipeline({
    label,
    layout: 'auto',
    compute: { module: device.createShaderModule({ label, code }) },
  });

function bound(device, pipeline, resources) {
  const entries = resources.map((resource, binding) => ({ binding, resource }));
  return device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries });
}

function tiled(encoder, pipeline, group, { width, height }) {
  const compute = encoder.beginComputePass();
  compute.setPipeline(pipeline);
  compute.setBindGroup(0, group);
  compute.dispatchWorkgroups(Math.ceil(width / 8), Math.ceil(height / 8));
  compute.end();
}

const READER = `
struct Frame { inverse_projection: mat4x4f, size: vec2u }
@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var depths: texture_depth_2d;
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> position: array<f32>;
@group(0) @binding(4) var<storage, read_write> normal: array<f32>;
@group(0) @binding(5) var<storage, read_write> valid: array<f32>;

@compute @workgroup_size(8, 8)
fn read_textures(@builtin(global_invocation_id) id: vec3u) {
  if (any(id.xy >= frame.size)) { return; }
  let pixels = frame.size.x * frame.size.y;
  let pixel = id.y * frame.size.x + id.x;
  let depth = textureLoad(depths, id.xy, 0);
  let seen = depth != BACKGROUND;
  let place = (vec2f(id.xy) + 0.5) / vec2f(frame.size);
  let at = frame.inverse_projection * vec4f(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, depth, 1.0);
  let point = select(vec3f(0.0), at.xyz / at.w, seen);
  let held = SCALE * textureLoad(normals, id.xy, 0).xyz + OFFSET;
  let unit = select(vec3f(0.0), held / max(length(held), 1e-6), seen);
  for (var c = 0u; c < 3u; c++) {
    position[c * pixels + pixel] = point[c];
    normal[c * pixels + pixel] = unit[c];
  }
  valid[pixel] = select(0.0, 1.0, seen);
}`;

const WRITER = `
@group(0) @binding(0) var<storage, read> image: array<f32>;
@group(0) @binding(1) var texture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn write_texture(@builtin(global_invocation_id) id: vec3u) {
  let size = textureDimensions(texture);
  if (any(id.xy >= size)) { return; }
  let pixel = id.y * size.x + id.x;
  var colour = vec3f(image[pixel]);
  for (var c = 1u; c < min(CHANNELS, 3u); c++) { colour[c] = image[c * size.x * size.y + pixel]; }
  textureStore(texture, id.xy, vec4f(colour, 1.0));
}`;
