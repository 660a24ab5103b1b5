//! Text in columns.

/// Rows under a heading; columns become as wide as they need.
#[derive(Debug)]
pub struct Columns {
    rows: Vec<Vec<String>>,
}

impl Columns {
    /// Columns with a heading.
    pub fn new(heading: &[&str]) -> Self {
        Self {
            rows: vec![heading.iter().map(|&s| s.to_owned()).collect()],
        }
    }

    /// Adds a row; it has as many cells as the heading.
    pub fn row<const N: usize>(&mut self, cells: [String; N]) {
        self.rows.push(cells.into());
    }

    /// Lines with two spaces before each. Columns of numbers are aligned to the right, empty
    /// columns are left out.
    pub fn indented(&self) -> String {
        let Some((heading, body)) = self.rows.split_first() else {
            return String::new();
        };
        let columns: Vec<(usize, usize, bool)> = (0..heading.len())
            .filter(|&i| body.iter().any(|row| !row[i].is_empty()))
            .map(|i| {
                let width = |row: &Vec<String>| row[i].chars().count();
                let numeric = body
                    .iter()
                    .all(|row| row[i].is_empty() || row[i].parse::<f64>().is_ok());
                (i, self.rows.iter().map(width).max().unwrap_or(0), numeric)
            })
            .collect();
        let mut text = String::new();
        for row in &self.rows {
            let mut line = String::new();
            for &(i, width, numeric) in &columns {
                let cell = &row[i];
                let padding = " ".repeat(width - cell.chars().count());
                line.push_str("  ");
                if numeric {
                    line.push_str(&padding);
                    line.push_str(cell);
                } else {
                    line.push_str(cell);
                    line.push_str(&padding);
                }
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_align_numbers_right_and_words_left() {
        let mut columns = Columns::new(&["name", "n", "empty"]);
        columns.row(["a".to_owned(), "1".to_owned(), String::new()]);
        columns.row(["long".to_owned(), "-10.5".to_owned(), String::new()]);
        assert_eq!(
            columns.indented(),
            "  name      n\n  a         1\n  long  -10.5\n"
        );
    }
}
