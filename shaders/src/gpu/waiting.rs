//! Waiting for the device: the one place where programs and web pages differ. A program waits; in a page,
//! which may not, the same work is awaited, and goes on when the browser says that the device is done.

use super::GpuError;

/// Does to its end what awaits the device. In a browser only what has nothing to await comes to an end.
///
/// # Errors
/// In a browser, where there is something to await.
#[cfg(not(target_arch = "wasm32"))]
pub fn wait<T>(work: impl Future<Output = T>) -> Result<T, GpuError> {
    Ok(pollster::block_on(work))
}

/// Does to its end what awaits the device. In a browser only what has nothing to await comes to an end.
///
/// # Errors
/// In a browser, where there is something to await.
#[cfg(target_arch = "wasm32")]
pub fn wait<T>(work: impl Future<Output = T>) -> Result<T, GpuError> {
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match std::pin::pin!(work).poll(&mut context) {
        std::task::Poll::Ready(made) => Ok(made),
        std::task::Poll::Pending => Err(GpuError::Page),
    }
}

/// Until all submitted work is done.
///
/// # Errors
/// If the device is lost; `label` names what it was to do.
pub async fn idle(device: &wgpu::Device, queue: &wgpu::Queue, label: &str) -> Result<(), GpuError> {
    let refused = |what: String| GpuError::Refused { label: format!("deepshade.{label}"), what };
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| refused(e.to_string()))?;
    if cfg!(target_arch = "wasm32") {
        let (done, all_done) = futures_channel::oneshot::channel();
        // Who has given up waiting is told nothing.
        queue.on_submitted_work_done(move || {
            let _ = done.send(());
        });
        all_done.await.map_err(|e| refused(e.to_string()))?;
    }
    Ok(())
}
