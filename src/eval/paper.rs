//! What the thesis reports of its networks (Table 7.1).

/// A row of the table.
pub struct Published {
    /// Name of our model's folder.
    pub model: &'static str,
    /// SSIM on its test set.
    pub ssim: f64,
    /// Milliseconds for 768 x 512 pixels on a GeForce GTX 1070, all colour channels.
    pub milliseconds: f64,
}

/// The paper's target for indirect light is a screen-space method's image, and it knows one sky: its figures
/// are those of `gi-paper` and `do-paper`. Its photographs are not to be had: its tenth network has no row.
const TABLE: [Published; 9] = [
    row("ao", 0.805, 9.0),
    row("gi-paper", 0.798, 28.0),
    row("dof", 0.959, 27.0),
    row("motion-blur", 0.937, 26.0),
    row("sss", 0.905, 27.0),
    row("aa", 0.982, 1.8),
    row("multi", 0.933, 26.0),
    row("ibl-paper", 0.973, 21.0),
    row("do-paper", 0.589, 26.0),
];

const fn row(model: &'static str, ssim: f64, milliseconds: f64) -> Published {
    Published { model, ssim, milliseconds }
}

/// What the thesis reports of a network.
pub fn published(model: &str) -> Option<&'static Published> {
    TABLE.iter().find(|row| row.model == model)
}
