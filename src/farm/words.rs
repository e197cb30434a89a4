//! Hours and bytes in units in which they are no zeros.

/// Hours, as minutes or seconds where they are few.
pub fn time(hours: f64) -> String {
    let seconds = 3600.0 * hours;
    if seconds < 60.0 {
        format!("{seconds:.1} s")
    } else if hours < 1.0 {
        format!("{:.1} min", 60.0 * hours)
    } else {
        format!("{hours:.2} h")
    }
}

/// Bytes, as megabytes below a gigabyte.
pub fn size(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.1} MB", 1e-6 * bytes) } else { format!("{:.1} GB", 1e-9 * bytes) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_is_not_nothing() {
        assert_eq!(
            [0.0, 0.001, 0.25, 1.0, 123.456].map(time),
            ["0.0 s", "3.6 s", "15.0 min", "1.00 h", "123.46 h"]
        );
        assert_eq!([2.6e5, 3e8, 4.2e9].map(size), ["0.3 MB", "300.0 MB", "4.2 GB"]);
    }
}
