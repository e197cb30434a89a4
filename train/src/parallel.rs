//! Data-parallel steps: the images of a batch are shared out over devices, each with the network's weights,
//! and the gradients of all are summed.
//!
//! burn's collective operations (`DistributedContext`) are for CUDA and remote devices alone in 0.22. This is
//! what its learner does on all others: a fork of the network a device, gradients brought to the first and
//! accumulated there. Shares are summed in the order of the devices, whichever is done first, so that a run
//! gives the same bits each time. With another number of devices sums are rounded otherwise: see the test for
//! how far.

use crate::Loss;
use crate::loader::{Batch, Tensors};
use crate::net::UNet;
use burn::module::Module;
use burn::optim::{GradientsAccumulator, GradientsParams};
use burn::tensor::Device;
use std::panic::resume_unwind;
use std::thread;

/// The loss of a batch, and its gradients on the first device.
pub(crate) fn gradients(net: &UNet, loss: Loss, batch: Batch, devices: &[Device]) -> (f32, GradientsParams) {
    let images = batch.images() as f32;
    let shares = batch.shared(devices.len());
    if let [device] = devices {
        let whole = shares.into_iter().next().expect("a device's share");
        return of_share(net, loss, whole, 1.0, device);
    }
    let made: Vec<(f32, GradientsParams)> = thread::scope(|scope| {
        let start = |(share, device): (Batch, &Device)| {
            let (net, device) = (net.clone(), device.clone());
            scope.spawn(move || {
                let weight = share.images() as f32 / images;
                of_share(&net.fork(&device), loss, share, weight, &device)
            })
        };
        let threads: Vec<_> = shares.into_iter().zip(devices).map(start).collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
    });
    let mut sum = GradientsAccumulator::new();
    let mut value = 0.0;
    for (share, gradients) in made {
        value += share;
        sum.accumulate(net, gradients.to_device(&devices[0], net));
    }
    (value, sum.grads())
}

/// The loss of a share, multiplied by its part of the batch, and its gradients.
fn of_share(net: &UNet, loss: Loss, share: Batch, weight: f32, device: &Device) -> (f32, GradientsParams) {
    let Tensors { input, target, exposure } = share.into_tensors(device);
    let loss = loss.of(net.unbounded(input) * exposure, target) * weight;
    // Reading the loss waits for the device: it is given the gradients to find first.
    let gradients = GradientsParams::from_grads(loss.clone().backward(), net);
    (loss.into_scalar(), gradients)
}
