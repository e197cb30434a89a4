//! A line of the file that the tests write what they compare into: a flat JSON object.

/// A measured value beside what it should be, or, for a control, beside what it must not be.
pub struct Comparison {
    /// As it was written.
    pub line: String,
    /// Of the proof.
    pub name: String,
    pub value: f64,
    pub expected: f64,
    /// None of a probability or a ratio.
    pub standard_error: Option<f64>,
    /// Whether the value is what it is compared with.
    pub within: bool,
    /// Whether it must not be.
    pub control: bool,
}

impl Comparison {
    /// `None` of anything else.
    pub fn parse(line: &str) -> Option<Self> {
        let number = |key: &str| field(line, key)?.parse().ok();
        let truth = |key: &str| field(line, key)?.parse().ok();
        Some(Self {
            line: line.to_owned(),
            name: field(line, "name")?.trim_matches('"').to_owned(),
            value: number("value")?,
            expected: number("expected")?,
            standard_error: number("standard_error"),
            within: truth("within")?,
            control: truth("control")?,
        })
    }

    /// Whether it came out as it must.
    pub const fn holds(&self) -> bool {
        self.within != self.control
    }

    /// In standard errors.
    pub fn deviation(&self) -> Option<f64> {
        self.standard_error.map(|error| (self.value - self.expected) / error)
    }

    /// The effect whose error's slope it is.
    pub fn slope_of(&self) -> Option<&str> {
        self.name.strip_prefix("slope/")
    }
}

/// The value of a key; there are no commas in values.
fn field<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!("\"{key}\": "))?;
    rest.split([',', '}']).next()
}
