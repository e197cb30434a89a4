//! Tables, for a terminal and as Markdown: columns as wide as what they hold.

/// Lines of a table whose first row is its head. Columns of numbers end at the right, others begin at the
/// left; rows may have empty cells, and as many as the head.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let (cells, _) = padded(rows);
    let lines: Vec<String> = cells.iter().map(|row| row.join("  ").trim_end().to_owned()).collect();
    lines.join("\n")
}

/// The same as Markdown, a line each.
pub fn markdown(rows: &[Vec<String>]) -> Vec<String> {
    let (cells, numbers) = padded(rows);
    let rule = cells[0].iter().zip(&numbers).map(|(cell, number)| {
        let dashes = "-".repeat(cell.chars().count() + 1);
        dashes + if *number { ":" } else { "-" }
    });
    let rule = format!("|{}|", rule.collect::<Vec<_>>().join("|"));
    let mut lines: Vec<String> = cells.iter().map(|row| format!("| {} |", row.join(" | "))).collect();
    lines.insert(1, rule);
    lines
}

/// The cells, all of a column of one width, and which columns are of numbers.
fn padded(rows: &[Vec<String>]) -> (Vec<Vec<String>>, Vec<bool>) {
    let columns = rows.first().map_or(0, Vec::len);
    let of_column = |column: usize| rows.iter().map(move |row| row[column].as_str());
    let widths: Vec<usize> = (0..columns)
        .map(|column| of_column(column).map(|cell| cell.chars().count()).max().unwrap_or(0))
        .collect();
    let numbers: Vec<bool> = (0..columns).map(|column| of_column(column).skip(1).all(is_number)).collect();
    let row = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).zip(&numbers).map(|((cell, &width), number)| {
            if *number { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
        });
        cells.collect()
    };
    (rows.iter().map(row).collect(), numbers)
}

/// Whether a cell has a number, maybe with its interval, or nothing.
fn is_number(cell: &str) -> bool {
    let start = cell.trim_start_matches(['+', '-']);
    cell.is_empty()
        || start.starts_with(|first: char| first.is_ascii_digit())
        || start == "NaN"
        || start == "inf"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stay_in_line_however_long_a_cell_is() {
        let row = |cells: [&str; 3]| cells.map(str::to_owned).to_vec();
        let rows = [
            row(["method", "SSIM", "on"]),
            row(["a_long_name", "0.5 [0.4, 0.6]", "llvmpipe"]),
            row(["b", "-12.25", ""]),
            row(["white", "", "a processor"]),
        ];
        let expected = "method                 SSIM  on\n\
                        a_long_name  0.5 [0.4, 0.6]  llvmpipe\n\
                        b                    -12.25\n\
                        white                        a processor";
        assert_eq!(aligned(&rows), expected);
        assert_eq!(aligned(&[]), "");
        let expected = [
            "| method      |           SSIM | on          |",
            "|-------------|---------------:|-------------|",
            "| a_long_name | 0.5 [0.4, 0.6] | llvmpipe    |",
        ];
        assert_eq!(markdown(&rows)[..3], expected);
    }
}
