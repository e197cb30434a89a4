//! The passes of a method, bound and ready to run as often as wanted.

use super::{Inputs, Resources, ScreenMethod, View};
use crate::method::Repeats;
use deepshade_shaders::gpu::{self, BoundPass, Gpu, GpuError, Pass, Stamps};
use deepshade_shaders::lists;
use web_time::Instant;

/// How many workgroups of a pass run.
#[derive(Clone, Debug)]
pub enum Workgroups {
    /// In x, y and z.
    Known([u32; 3]),
    /// What an earlier pass has written into a buffer, three words from that byte on.
    Counted(wgpu::Buffer, u64),
}

impl From<[u32; 3]> for Workgroups {
    fn from(known: [u32; 3]) -> Self {
        Self::Known(known)
    }
}

/// A bound pass and how many workgroups of it run.
#[derive(Clone, Debug)]
pub struct PassDispatch {
    /// What runs.
    pub pass: BoundPass,
    /// How often.
    pub workgroups: Workgroups,
}

impl PassDispatch {
    /// Records it in a compute pass of its own.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, label: &str, stamps: Option<&Stamps<'_>>) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: stamps.map(Stamps::of_compute),
        });
        self.encode_in(&mut pass);
    }

    /// Records it within a compute pass of the caller's.
    pub fn encode_in(&self, pass: &mut wgpu::ComputePass<'_>) {
        match &self.workgroups {
            Workgroups::Known(workgroups) => self.pass.dispatch_in(pass, *workgroups),
            Workgroups::Counted(buffer, offset) => self.pass.dispatch_counted_in(pass, buffer, *offset),
        }
    }
}

/// A pass of a method, and what it writes.
#[derive(Clone, Debug)]
pub struct MethodStep {
    /// What runs.
    pub step: PassDispatch,
    /// Where it writes, in the order of its bindings. A later pass may write there again.
    pub writes: Vec<wgpu::Buffer>,
}

impl MethodStep {
    /// Binds a pass to buffers in the order of its bindings, of which it writes the last ones.
    ///
    /// # Errors
    /// If they are not what the pass declares and uses.
    pub fn bind(
        device: &wgpu::Device,
        pass: &Pass,
        workgroups: impl Into<Workgroups>,
        reads: &[&wgpu::Buffer],
        writes: &[&wgpu::Buffer],
    ) -> Result<Self, GpuError> {
        let numbered: Vec<(u32, &wgpu::Buffer)> = (0..).zip([reads, writes].concat()).collect();
        let (reads, writes) = numbered.split_at(reads.len());
        Self::bind_at(device, pass, workgroups, reads, writes)
    }

    /// Binds a pass to buffers by the numbers of its bindings.
    ///
    /// # Errors
    /// If they are not what the pass declares and uses.
    pub fn bind_at(
        device: &wgpu::Device,
        pass: &Pass,
        workgroups: impl Into<Workgroups>,
        reads: &[(u32, &wgpu::Buffer)],
        writes: &[(u32, &wgpu::Buffer)],
    ) -> Result<Self, GpuError> {
        let all = reads.iter().chain(writes);
        let pass =
            pass.bind_at(device, all.map(|(binding, buffer)| (*binding, buffer.as_entire_binding())))?;
        let writes = writes.iter().map(|(_, buffer)| (*buffer).clone()).collect();
        Ok(Self { step: PassDispatch { pass, workgroups: workgroups.into() }, writes })
    }

    /// The same as one of a part of its method.
    #[must_use]
    pub fn within(mut self, part: &str) -> Self {
        self.step.pass = self.step.pass.within(part);
        self
    }
}

/// What passes of one key take.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime<K> {
    /// What is alike of them.
    pub key: K,
    /// How many they are.
    pub passes: usize,
    /// Time of all of them, milliseconds: the sum of the medians of those that follow one another.
    pub milliseconds: f64,
}

/// The passes of a method for one g-buffer on the GPU.
#[derive(Clone, Debug)]
pub struct MethodPasses {
    label: String,
    steps: Vec<MethodStep>,
    uniforms: Vec<wgpu::Buffer>,
    output: wgpu::Buffer,
}

impl MethodPasses {
    /// Binds a method's passes.
    ///
    /// # Errors
    /// If the device has no room, or refuses a binding.
    pub fn new(method: &ScreenMethod, inputs: &Inputs<'_>, view: &View) -> Result<Self, GpuError> {
        let device = &method.device;
        let name = method.name();
        let uniforms = method.technique.uniforms(view);
        let uniforms = uniforms
            .iter()
            .enumerate()
            .map(|(index, bytes)| gpu::uniforms(device, &format!("{name}.uniform_{index}"), bytes));
        let uniforms: Vec<wgpu::Buffer> = uniforms.collect::<Result<_, GpuError>>()?;
        let count = method.effect().channels() * view.height * view.width;
        let output = gpu::empty::<f32>(device, &format!("{name}.output"), count)?;
        let Inputs { gbuffer, environment, world } = *inputs;
        let to = Resources { device, gbuffer, environment, world, uniforms: &uniforms, output: &output };
        let steps = method.technique.steps(&to)?;
        Ok(Self { label: format!("deepshade.{name}"), steps, uniforms, output })
    }

    /// Tells the passes of another view of the same size. Nothing is allocated on the GPU.
    pub fn look(&self, queue: &wgpu::Queue, method: &ScreenMethod, view: &View) {
        for (buffer, bytes) in self.uniforms.iter().zip(method.technique.uniforms(view)) {
            queue.write_buffer(buffer, 0, &bytes);
        }
    }

    /// Records all passes within one compute pass of wgpu's.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(&self.label),
            timestamp_writes: None,
        });
        self.encode_in(&mut pass);
    }

    /// Records all passes within a compute pass of the caller's.
    pub fn encode_in(&self, pass: &mut wgpu::ComputePass<'_>) {
        for MethodStep { step, .. } in &self.steps {
            step.encode_in(pass);
        }
    }

    /// What they take by a key, in the order in which each runs first. All run once a frame, as they do in
    /// use, since a pass that ran twice in a row would find what others have not made anew. Passes of one key
    /// that follow one another are timed together. No further run begins once 10 s are over.
    ///
    /// # Errors
    /// If the device fails.
    pub fn times<K: PartialEq>(
        &self,
        gpu: &Gpu,
        repeats: Repeats,
        key: impl Fn(&MethodStep) -> K,
    ) -> Result<Vec<PassTime<K>>, GpuError> {
        let together: Vec<&[MethodStep]> = self.steps.chunk_by(|a, b| key(a) == key(b)).collect();
        let mut runs = vec![Vec::new(); together.len()];
        let start = Instant::now();
        for run in 0..repeats.warm_up + repeats.timed.max(1) {
            let is_timed = run >= repeats.warm_up || start.elapsed() > gpu::PATIENCE;
            for (steps, runs) in together.iter().zip(&mut runs) {
                let milliseconds = self.time_once(gpu, steps)?;
                if is_timed {
                    runs.push(milliseconds);
                }
            }
            if is_timed && start.elapsed() > gpu::PATIENCE {
                break;
            }
        }
        let mut times: Vec<PassTime<K>> = Vec::new();
        for (steps, runs) in together.into_iter().zip(runs) {
            let (key, passes, milliseconds) = (key(&steps[0]), steps.len(), lists::median(runs));
            match times.iter_mut().find(|time| time.key == key) {
                Some(time) => {
                    time.passes += passes;
                    time.milliseconds += milliseconds;
                }
                None => times.push(PassTime { key, passes, milliseconds }),
            }
        }
        Ok(times)
    }

    /// How long some of the passes take, once.
    fn time_once(&self, gpu: &Gpu, steps: &[MethodStep]) -> Result<f64, GpuError> {
        let timing = gpu::time(&gpu.device, &gpu.queue, &self.label, 0, 1, |encoder| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            steps.iter().for_each(|step| step.step.encode_in(&mut pass));
        })?;
        Ok(timing.milliseconds)
    }

    /// The passes in order, for whoever wants what lies between them.
    pub fn steps(&self) -> &[MethodStep] {
        &self.steps
    }

    /// The image, `[channels, height, width]` f32.
    pub const fn output(&self) -> &wgpu::Buffer {
        &self.output
    }
}
