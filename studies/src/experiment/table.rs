//! What a study found: a table whose first column is its figures, and how it is written.

use deepshade::shared::figures::Figures;
use deepshade::shared::plot::Plot;
use deepshade::shared::table;
use serde_json::json;

/// What a study found.
#[derive(Clone, Debug)]
pub struct Table {
    /// What was studied.
    pub title: &'static str,
    /// What a row is.
    pub rows_are: &'static str,
    /// Names of the values of a row, with the digits after the point; the first is what figures give.
    pub columns: Vec<(&'static str, usize)>,
    /// One row for everything compared.
    pub rows: Vec<Row>,
    /// The table as a picture.
    pub plot: Plot,
}

/// Values of one of the things compared.
#[derive(Clone, Debug)]
pub struct Row {
    /// Name of its figure, which no other row has.
    pub figure: String,
    /// What the table calls it.
    pub label: String,
    /// As many as there are columns; what is not finite is not known.
    pub values: Vec<f64>,
}

impl Row {
    /// A row of some columns' values; those behind them are not known.
    pub fn new(figure: impl Into<String>, label: impl Into<String>, values: &[f64]) -> Self {
        Self { figure: figure.into(), label: label.into(), values: values.to_vec() }
    }
}

impl Table {
    /// Sets one figure a row, and all values as a detail.
    pub fn set_figures(&self, figures: &mut Figures) {
        for row in &self.rows {
            figures.set(&row.figure, row.values[0]);
        }
        let names: Vec<&str> = self.columns.iter().map(|column| column.0).collect();
        figures.detail("columns", json!(names));
        let rows = self.rows.iter().map(|row| (row.figure.clone(), json!(row.values)));
        figures.detail("rows", rows.collect());
    }

    /// The table as comma-separated values, with all digits.
    pub fn csv(&self) -> String {
        let names = self.columns.iter().map(|column| column.0);
        let mut lines =
            vec![["figure", self.rows_are].into_iter().chain(names).collect::<Vec<_>>().join(",")];
        for row in &self.rows {
            let numbers = row
                .values
                .iter()
                .map(|value| if value.is_finite() { value.to_string() } else { String::new() });
            lines.push(
                [row.figure.clone(), row.label.clone()]
                    .into_iter()
                    .chain(numbers)
                    .collect::<Vec<_>>()
                    .join(","),
            );
        }
        lines.join("\n") + "\n"
    }

    /// The table as Markdown, aligned, a line each.
    pub fn lines(&self) -> Vec<String> {
        let names = self.columns.iter().map(|column| column.0.to_owned());
        let mut cells: Vec<Vec<String>> =
            vec![std::iter::once(self.rows_are.to_owned()).chain(names).collect()];
        cells.extend(self.rows.iter().map(|row| self.cells(row)));
        table::markdown(&cells)
    }

    fn cells(&self, row: &Row) -> Vec<String> {
        let number = |index: usize, digits: usize| {
            let value = row.values.get(index).filter(|value| value.is_finite());
            value.map_or_else(String::new, |value| format!("{value:.digits$}"))
        };
        let numbers = self.columns.iter().enumerate().map(|(index, column)| number(index, column.1));
        std::iter::once(row.label.clone()).chain(numbers).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade::shared::plot::Line;

    fn table() -> Table {
        let lines = vec![Line::dotted("a", vec![(1.0, 0.5)])];
        Table {
            title: "Kernels",
            rows_are: "network",
            columns: vec![("SSIM", 3), ("ms", 1)],
            rows: vec![
                Row::new("ssim_small", "small", &[0.71234, 12.0]),
                Row::new("ssim_white", "white", &[0.5]),
            ],
            plot: Plot { x: "ms", is_logarithmic: false, y: "SSIM", lines, level: None },
        }
    }

    #[test]
    fn columns_are_aligned_and_what_is_not_known_is_blank() {
        let expected = [
            "| network |  SSIM |   ms |",
            "|---------|------:|-----:|",
            "| small   | 0.712 | 12.0 |",
            "| white   | 0.500 |      |",
        ];
        assert_eq!(table().lines(), expected);
        let csv = "figure,network,SSIM,ms\nssim_small,small,0.71234,12\nssim_white,white,0.5\n";
        assert_eq!(table().csv(), csv);
    }

    #[test]
    fn a_row_is_a_figure() {
        let mut figures = Figures::new("experiment");
        table().set_figures(&mut figures);
        assert_eq!(figures.get("ssim_small"), Some(0.71234));
        assert_eq!(figures.to_json()["details"]["rows"]["ssim_white"], json!([0.5]));
    }
}
