//! Tables of numbers in CSV files, with a first line of names. What is wrong is said with file and line.

use std::path::{Path, PathBuf};

/// A table of numbers.
#[derive(Clone, Debug)]
pub struct Table {
    path: PathBuf,
    names: Vec<String>,
    /// A row's line in the file, and one number a name; 0 in columns of text.
    rows: Vec<(usize, Vec<f64>)>,
    /// What is in each of the columns of text, where there is one.
    texts: [Vec<String>; TEXTS.len()],
}

/// The columns whose cells are names, and what one is: of files, and of patches of a colour chart.
const TEXTS: [(&str, &str); 2] = [(FILE, "a file"), (PATCH, "the name of a patch")];
const FILE: &str = "file";
const PATCH: &str = "patch";

/// Whether the cells of a column are names, and no numbers.
pub fn holds_names(column: &str) -> bool {
    TEXTS.iter().any(|(name, _)| *name == column)
}

/// Why a table cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// It cannot be read.
    #[error("cannot read the table {}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It is not text of the right form.
    #[error("{} is no table", path.display())]
    Form {
        /// The file.
        path: PathBuf,
        /// Why.
        source: csv::Error,
    },
    /// A fault of one of its rows.
    #[error("{}:{line}: {fault}", path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// The line, from 1 on.
        line: usize,
        /// What is wrong.
        fault: String,
    },
    /// A fault of the table as a whole.
    #[error("{} {fault}", path.display())]
    Whole {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        fault: String,
    },
}

impl Table {
    /// Reads a table. Blanks around names and numbers do not count; lines that start with `#` are left out.
    ///
    /// # Errors
    /// If it cannot be read, columns are not separated by commas, two have one name, a row is longer or
    /// shorter than the first line, a cell is no finite number, or there is no row.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let text =
            std::fs::read_to_string(path).map_err(|source| TableError::Read { path: path.into(), source })?;
        let fails = |source| TableError::Form { path: path.into(), source };
        let mut reader = csv::ReaderBuilder::new();
        let reader = reader.trim(csv::Trim::All).comment(Some(b'#')).flexible(true);
        let mut reader = reader.from_reader(text.as_bytes());
        let names: Vec<String> = reader.headers().map_err(fails)?.iter().map(Into::into).collect();
        let mut table = Self { path: path.into(), names, rows: Vec::new(), texts: Default::default() };
        if let Some(name) = table.names.iter().find(|name| name.contains([';', '\t'])) {
            let fault = format!(
                "has {name:?} in its first line: columns are separated by commas, not by semicolons or tabs, and decimals by a point"
            );
            return Err(table.says(fault));
        }
        if let Some(name) = table.twice() {
            return Err(table.says(format!("has two columns {name}")));
        }
        // What the reader says of places does not count the lines that it leaves out.
        let read = |(_, line): &(usize, &str)| !line.is_empty() && !line.starts_with('#');
        let mut lines = (1..).zip(text.lines()).filter(read).skip(1);
        for record in reader.records() {
            let record = record.map_err(fails)?;
            let (line, _) = lines.next().ok_or_else(|| {
                table.says("has more rows than lines: one ends in a carriage return alone".into())
            })?;
            let row = table.row(line, &record)?;
            for (index, (name, _)) in TEXTS.into_iter().enumerate() {
                let text = table.index(name).and_then(|column| record.get(column));
                table.texts[index].extend(text.map(str::to_owned));
            }
            table.rows.push((line, row));
        }
        if table.rows.is_empty() { Err(table.says("has no row of numbers".into())) } else { Ok(table) }
    }

    /// The names of its columns.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Whether all columns are some of these, which `what` has, in words.
    ///
    /// # Errors
    /// If one is not; it is named.
    pub fn has_only(&self, known: &[&str], what: &str) -> Result<(), TableError> {
        let Some(name) = self.names.iter().find(|name| !known.contains(&name.as_str())) else {
            return Ok(());
        };
        let known = known.join(", ");
        Err(self.says(format!("has a column {name}, which means nothing: {what} has {known}")))
    }

    /// A name that several columns have.
    fn twice(&self) -> Option<&String> {
        let mut names = self.names.iter().enumerate();
        names.find(|(index, name)| self.names[..*index].contains(name)).map(|(_, name)| name)
    }

    /// The column of names of files, if there is one.
    pub fn files(&self) -> Option<&[String]> {
        self.text(FILE)
    }

    /// The column of names of patches, if there is one.
    pub fn patches(&self) -> Option<&[String]> {
        self.text(PATCH)
    }

    fn text(&self, name: &str) -> Option<&[String]> {
        let index = TEXTS.iter().position(|(text, _)| *text == name)?;
        self.index(name).map(|_| &self.texts[index][..])
    }

    /// A column.
    ///
    /// # Errors
    /// If there is none of this name.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, TableError> {
        self.values(name, |_, _| true, "")
    }

    /// A column, or its value everywhere where there is none.
    ///
    /// # Errors
    /// If a value of the column is not above 0.
    pub fn positive_or(&self, name: &str, otherwise: f64) -> Result<Vec<f64>, TableError> {
        if self.index(name).is_none() {
            return Ok(vec![otherwise; self.rows.len()]);
        }
        self.values(name, |_, value| value > 0.0, "it must be above 0")
    }

    /// A column of numbers that are at least 0.
    ///
    /// # Errors
    /// If there is none of this name, or a value is negative.
    pub fn not_negative(&self, name: &str) -> Result<Vec<f64>, TableError> {
        self.values(name, |_, value| value >= 0.0, "it must be at least 0")
    }

    /// A column of numbers that count from 1 to `count`, from 0 on.
    ///
    /// # Errors
    /// If there is none of this name, or a value is no such number.
    pub fn indices(&self, name: &str, count: usize) -> Result<Vec<usize>, TableError> {
        let counts = |_, value: f64| value.fract() == 0.0 && value >= 1.0 && value <= count as f64;
        let values = self.values(name, counts, &format!("there are 1 to {count}"))?;
        Ok(values.into_iter().map(|value| value as usize - 1).collect())
    }

    /// A column in which every number is above the one before and at least 0: times, wavelengths.
    ///
    /// # Errors
    /// If there is none of this name, or it does not ascend.
    pub fn ascending(&self, name: &str) -> Result<Vec<f64>, TableError> {
        let rises =
            |before: Option<f64>, value: f64| value >= 0.0 && before.is_none_or(|before| value > before);
        self.values(name, rises, "it must be at least 0 and above the one before")
    }

    /// A fault of the table as a whole.
    pub fn says(&self, fault: String) -> TableError {
        TableError::Whole { path: self.path.clone(), fault }
    }

    /// A fault of one of its rows, from 0 on.
    pub fn says_of_row(&self, row: usize, fault: String) -> TableError {
        match self.rows.get(row) {
            Some((line, _)) => self.says_of(*line, fault),
            None => self.says(fault),
        }
    }

    fn says_of(&self, line: usize, fault: String) -> TableError {
        TableError::Row { path: self.path.clone(), line, fault }
    }

    fn index(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|candidate| candidate == name)
    }

    /// A column whose values, each with the one before, are all `good`.
    fn values(
        &self,
        name: &str,
        good: impl Fn(Option<f64>, f64) -> bool,
        must: &str,
    ) -> Result<Vec<f64>, TableError> {
        let missing = || self.says(format!("has no column {name}; it has {}", self.names.join(", ")));
        let index = self.index(name).ok_or_else(missing)?;
        let mut values: Vec<f64> = Vec::with_capacity(self.rows.len());
        for (line, row) in &self.rows {
            let value = row[index];
            if !good(values.last().copied(), value) {
                return Err(self.says_of(*line, format!("{name} is {value}, {must}")));
            }
            values.push(value);
        }
        Ok(values)
    }

    fn row(&self, line: usize, record: &csv::StringRecord) -> Result<Vec<f64>, TableError> {
        if record.len() != self.names.len() {
            let (cells, columns) = (record.len(), self.names.len());
            return Err(self.says_of(line, format!("{cells} cells, the first line has {columns}")));
        }
        let number = |(text, column): (&str, &String)| {
            let named = TEXTS.iter().find(|(name, _)| name == column);
            let wanted = named.map_or("a finite number", |(_, wanted)| wanted);
            let fails = || self.says_of(line, format!("{column} is {text:?}, not {wanted}"));
            if named.is_some() {
                return if text.is_empty() { Err(fails()) } else { Ok(0.0) };
            }
            text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(fails)
        };
        record.iter().zip(&self.names).map(number).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Table, TableError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("decay.csv");
        std::fs::write(&path, text).expect("written");
        Table::read(&path)
    }

    #[test]
    fn columns_are_found_by_name() {
        let table = read("# measured on Monday\n time_s, red \n0,1\n0.5, 2e-3\n").expect("a table");
        assert_eq!(table.ascending("time_s").expect("times"), [0.0, 0.5]);
        assert_eq!(table.column("red").expect("red"), [1.0, 0.002]);
        assert_eq!(table.positive_or("iso", 100.0).expect("iso"), [100.0; 2]);
        assert!(
            table
                .column("blue")
                .expect_err("none")
                .to_string()
                .contains("no column blue; it has time_s, red")
        );
    }

    #[test]
    fn gaps_text_and_disorder_are_said_with_file_and_line() {
        let fault = |text| read(text).expect_err("a fault").to_string();
        assert!(fault("time_s,red\n0,1\n1,\n").ends_with("decay.csv:3: red is \"\", not a finite number"));
        assert!(
            fault("time_s,red\n0,1\n\n1,dark\n")
                .ends_with("decay.csv:4: red is \"dark\", not a finite number")
        );
        assert!(fault("time_s,red\nnan,1\n").contains(":2: time_s"));
        assert!(fault("time_s,red\n").ends_with("has no row of numbers"));
        assert!(fault("time_s,red;green\n0,1;5\n").contains(
            "decay.csv has \"red;green\" in its first line: columns are separated by commas, not by semicolons"
        ));
        assert!(fault("time_s\tred\n0\t1\n").contains("or tabs"));
        assert!(fault("red,time_s,red\n1,0,1\n").ends_with("has two columns red"));
        assert!(fault("time_s,red\n0,1\r1,2\n2,3\n").contains("a carriage return alone"));
        assert_eq!(read("red\r\n1\r\n2\r\n").expect("a table").column("red").expect("red"), [1.0, 2.0]);
        assert!(
            fault("time_s,red\n# a note\n0,1\n1\n").ends_with("decay.csv:4: 1 cells, the first line has 2")
        );
        let table = read("time_s,red\n0,1\n2,1\n1,1\n").expect("a table");
        let fault = table.ascending("time_s").expect_err("out of order").to_string();
        assert!(
            fault.ends_with("decay.csv:4: time_s is 1, it must be at least 0 and above the one before"),
            "{fault}"
        );
        assert!(read("red\n-1\n").expect("a table").not_negative("red").is_err());
        let fault = |text| {
            read(text).expect("a table").has_only(&["iso", "red"], "it").expect_err("a fault").to_string()
        };
        assert!(fault("iso,rad\n1,1\n").ends_with("has a column rad, which means nothing: it has iso, red"));
        assert!(read("iso\n0\n").expect("a table").positive_or("iso", 1.0).is_err());
    }
}
