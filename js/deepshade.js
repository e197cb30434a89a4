// Runs deepshade's networks in WebGPU, from the files that `deepshade export --wgsl` writes: all compute passes
// from a g-buffer to the effect's image. The files' own HOST.md says what they hold.

/** Fetches a network's files and compiles its passes. */
export async function load(url, device) {
  const folder = String(url).replace(/\/?$/, '/');
  const bytes = async (name) => {
    const response = await fetch(folder + name);
    if (!response.ok) throw new Error(`${folder}${name}: ${response.status} ${response.statusText}`);
    return response.arrayBuffer();
  };
  const text = async (name) => new TextDecoder().decode(await bytes(name));
  const description = JSON.parse(await text('network.json'));
  if (description.half && !device.features.has('shader-f16')) {
    throw new Error(`${folder}: the network needs a device with the feature shader-f16; export it without --half`);
  }
  const files = Object.entries(description.buffers).filter(([, buffer]) => buffer.file);
  const contents = new Map(await Promise.all(files.map(async ([name, { file }]) => [name, await bytes(file)])));
  const passes = await Promise.all(
    description.passes.map(async (pass) => compiled(device, pass, await text(pass.file))),
  );
  return new Network(device, description, passes, contents);
}

/**
 * Runs a network on the frame that was exported with it. Resolves to how far its image is off at most, and the
 * share of its values that are off by more than 1e-3: below .01 all is well.
 */
export async function check(url, network) {
  const folder = String(url).replace(/\/?$/, '/');
  const fetched = async (name) => (await fetch(`${folder}check.${name}`)).arrayBuffer();
  const numbers = JSON.parse(new TextDecoder().decode(await fetched('json')));
  const { height, width, radius, focal_length: focalLength, exposure, seed } = numbers;
  const { device } = network;
  const plan = network.plan(width, height);
  for (const { name } of network.attributes) {
    device.queue.writeBuffer(plan.buffers[name], 0, await fetched(`${name}.bin`));
  }
  plan.set({ radius, focalLength, exposure, seed });
  const encoder = device.createCommandEncoder();
  plan.encode(encoder);
  device.queue.submit([encoder.finish()]);
  const made = await read(plan.image, device);
  const expected = new Float32Array(await fetched('image.bin'));
  const apart = expected.map((value, index) => Math.abs(value - made[index]));
  const largest = apart.reduce((most, value) => (value > most || Number.isNaN(value) ? value : most), 0);
  plan.destroy();
  return { largest, stray: apart.filter((value) => !(value <= 1e-3)).length / apart.length };
}

/** The numbers of a buffer of a plan, such as `plan.image`. */
export async function read(buffer, device) {
  const usage = GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ;
  const copy = device.createBuffer({ size: buffer.size, usage });
  const encoder = device.createCommandEncoder();
  encoder.copyBufferToBuffer(buffer, 0, copy, 0, buffer.size);
  device.queue.submit([encoder.finish()]);
  await copy.mapAsync(GPUMapMode.READ);
  const numbers = new Float32Array(copy.getMappedRange().slice(0));
  copy.destroy();
  return numbers;
}

/** A network on a device. */
export class Network {
  constructor(device, description, passes, contents) {
    Object.assign(this, { device, description, passes });
    this.files = new Map([...contents].map(([name, content]) => [name, filled(device, name, content)]));
  }

  /** The effect's name. */
  get effect() {
    return this.description.effect;
  }

  /** The attributes of the g-buffer that it reads: names, and planes of each. */
  get attributes() {
    const planes = (name) => this.description.buffers[name].attribute;
    return this.description.attributes.map((name) => ({ name, planes: planes(name) }));
  }

  /** Bytes of an attribute's buffer for an image. */
  bytesOf(name, width, height) {
    return 4 * this.description.buffers[name].attribute * width * height;
  }

  /**
   * Prepares frames of a size. Buffers of attributes may be given; those that are not are made, to be filled
   * through `plan.buffers`.
   */
  plan(width, height, attributes = {}) {
    return new Plan(this, [height, width], attributes);
  }
}

/** A network for frames of a size. */
export class Plan {
  constructor(network, size, attributes) {
    const { device, description } = network;
    Object.assign(this, { network, size, width: size[1], height: size[0], own: [] });
    this.buffers = {};
    for (const [name, buffer] of Object.entries(description.buffers)) {
      this.buffers[name] = attributes[name] ?? network.files.get(name) ?? this.#made(name, buffer);
    }
    const runs = [...Array(description.runs).keys()];
    this.steps = runs.flatMap((run) =>
      network.passes.filter((pass) => run === 0 || pass.each_run).map((pass) => this.#step(pass, run)),
    );
    this.limits(device);
  }

  /** The effect's image: planes of the image, 32-bit floats, row by row from the top. */
  get image() {
    return this.buffers.image;
  }

  #made(name, buffer) {
    const bytes = buffer.attribute
      ? this.network.bytesOf(name, this.width, this.height)
      : buffer.made.reduce((sum, part) => sum + area(this.#extent(part.over)) * part.planes * part.bytes, 0);
    const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC | GPUBufferUsage.COPY_DST;
    const made = this.network.device.createBuffer({ label: `deepshade.${name}`, size: Math.max(bytes, 16), usage });
    this.own.push(made);
    return made;
  }

  /** Throws if the device does not allow a buffer as large as one that is needed. */
  limits(device) {
    for (const [name, buffer] of Object.entries(this.buffers)) {
      if (buffer.size > device.limits.maxStorageBufferBindingSize) {
        throw new Error(
          `${this.width}x${this.height}: the buffer ${name} needs ${buffer.size} bytes, the device allows ` +
            `${device.limits.maxStorageBufferBindingSize}; ask for more in requestDevice, or for smaller frames`,
        );
      }
    }
  }

  #extent({ align, shift }) {
    return this.size.map((size) => (Math.ceil(size / align) * align) >> shift);
  }

  #step(pass, run) {
    const { device } = this.network;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    const uniform = device.createBuffer({ label: `deepshade.${pass.name}`, size: pass.uniform_bytes, usage });
    this.own.push(uniform);
    const storage = Object.entries(pass.bindings).map(([binding, { buffer }]) => ({
      binding: Number(binding),
      resource: { buffer: this.buffers[buffer] },
    }));
    const entries = [{ binding: 0, resource: { buffer: uniform } }, ...storage];
    const group = device.createBindGroup({ layout: pass.layout, entries });
    const [rows, columns] = this.#extent(pass.over);
    const groups = [Math.ceil(columns / pass.tile[0]), Math.ceil(rows / pass.tile[1]), pass.workgroups_z];
    return { pass, run, uniform, group, groups };
  }

  /**
   * Tells the passes of a frame, from the next submission on: `radius` in the unit of positions, `focalLength`
   * in pixels, `exposure` for networks that read light.
   */
  set({ radius, focalLength, exposure = 1, seed = 0 }) {
    for (const [name, value] of Object.entries({ radius, focalLength, exposure, seed })) {
      if (!Number.isFinite(value)) throw new Error(`deepshade: ${name} is ${value}; a number is wanted`);
    }
    const frame = { radius, focal_length: focalLength, exposure, seed };
    for (const { pass, run, uniform } of this.steps) {
      const bytes = new DataView(new ArrayBuffer(pass.uniform_bytes));
      for (const { kind, offset, value } of pass.uniform) {
        const number = this.#told(value, { ...frame, run });
        if (kind === 'f32') bytes.setFloat32(offset, number, true);
        else if (kind === 'i32') bytes.setInt32(offset, number, true);
        else bytes.setUint32(offset, number, true);
      }
      this.network.device.queue.writeBuffer(uniform, 0, bytes.buffer);
    }
  }

  #told(value, frame) {
    if (value.rows) return this.#extent(value.rows)[0];
    if (value.columns) return this.#extent(value.columns)[1];
    if (value.times) return frame[value.times[0]] * value.times[1];
    if (value.over) return value.over[0] / frame[value.over[1]];
    return value.constant;
  }

  /** Records the passes, in a compute pass of their own. */
  encode(encoder, timestampWrites) {
    const compute = encoder.beginComputePass({ label: 'deepshade', timestampWrites });
    for (const { pass, group, groups } of this.steps) {
      compute.setPipeline(pass.pipeline);
      compute.setBindGroup(0, group);
      compute.dispatchWorkgroups(...groups);
    }
    compute.end();
  }

  /** Frees what the plan made. */
  destroy() {
    this.own.forEach((buffer) => buffer.destroy());
  }
}

/**
 * Writes the buffers `position`, `normal` and `valid` of a plan from what a rasteriser has: a depth texture and
 * a texture of normals in camera space. Camera space has x to the right, y up and z towards the camera.
 */
export class TextureReader {
  /**
   * `normals` says what the texture of normals holds: `unit`, components from -1 to 1, or `colour`, from 0 to
   * 1. `background` is the depth where nothing is seen: 1, or 0 with reversed depth.
   */
  constructor(device, { normals = 'unit', background = 1 } = {}) {
    const constants = `const BACKGROUND = ${background.toFixed(1)};\nconst SCALE = ${
      normals === 'colour' ? '2.0' : '1.0'
    };\nconst OFFSET = ${normals === 'colour' ? '-1.0' : '0.0'};\n`;
    const usage = GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST;
    this.device = device;
    this.uniform = device.createBuffer({ label: 'deepshade.reader', size: 80, usage });
    this.pipeline = device.createComputePipeline({
      label: 'deepshade.reader',
      layout: 'auto',
      compute: { module: device.createShaderModule({ code: constants + READER }) },
    });
  }

  /** Records it. `depth` and `normal` are texture views, `inverseProjection` 16 numbers, column after column. */
  encode(encoder, plan, { depth, normal, inverseProjection }) {
    const told = new DataView(new ArrayBuffer(80));
    Array.from(inverseProjection).forEach((number, index) => told.setFloat32(4 * index, number, true));
    told.setUint32(64, plan.width, true);
    told.setUint32(68, plan.height, true);
    this.device.queue.writeBuffer(this.uniform, 0, told.buffer);
    const resources = [{ buffer: this.uniform }, depth, normal];
    const buffers = ['position', 'normal', 'valid'].map((name) => ({ buffer: plan.buffers[name] }));
    const entries = [...resources, ...buffers].map((resource, binding) => ({ binding, resource }));
    const group = this.device.createBindGroup({ layout: this.pipeline.getBindGroupLayout(0), entries });
    tiled(encoder, this.pipeline, group, plan);
  }
}

/** Copies a plan's image into a texture of its own, `rgba16float`; a single channel goes into red, green and blue. */
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
    this.pipeline = device.createComputePipeline({
      label: 'deepshade.writer',
      layout: 'auto',
      compute: { module: device.createShaderModule({ code }) },
    });
    const resources = [{ buffer: plan.image }, this.texture.createView()];
    const entries = resources.map((resource, binding) => ({ binding, resource }));
    this.group = device.createBindGroup({ layout: this.pipeline.getBindGroupLayout(0), entries });
  }

  /** Records it. */
  encode(encoder) {
    tiled(encoder, this.pipeline, this.group, this.plan);
  }
}

function tiled(encoder, pipeline, group, { width, height }) {
  const compute = encoder.beginComputePass();
  compute.setPipeline(pipeline);
  compute.setBindGroup(0, group);
  compute.dispatchWorkgroups(Math.ceil(width / 8), Math.ceil(height / 8));
  compute.end();
}

const area = ([rows, columns]) => rows * columns;

function filled(device, name, content) {
  const size = Math.ceil(content.byteLength / 16) * 16;
  const usage = GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST;
  const buffer = device.createBuffer({ label: `deepshade.${name}`, size, usage });
  device.queue.writeBuffer(buffer, 0, content);
  return buffer;
}

async function compiled(device, pass, code) {
  const label = `deepshade.${pass.name}`;
  const storage = Object.entries(pass.bindings).map(([binding, { written }]) => ({
    binding: Number(binding),
    visibility: GPUShaderStage.COMPUTE,
    buffer: { type: written ? 'storage' : 'read-only-storage' },
  }));
  const uniform = { binding: 0, visibility: GPUShaderStage.COMPUTE, buffer: { type: 'uniform' } };
  const layout = device.createBindGroupLayout({ label, entries: [uniform, ...storage] });
  const pipeline = await device.createComputePipelineAsync({
    label,
    layout: device.createPipelineLayout({ bindGroupLayouts: [layout] }),
    compute: { module: device.createShaderModule({ label, code }), entryPoint: pass.entry },
  });
  return { ...pass, layout, pipeline };
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
