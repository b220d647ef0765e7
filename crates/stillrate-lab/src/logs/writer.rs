//! Columns back into delimited text, in the dialect they came in.
//!
//! Numbers are written with the fewest digits that read back to the same number.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::delimited::Column;

/// How to write a table.
///
/// # Example
/// ```
/// use stillrate_lab::logs::{delimited::Column, writer::{Style, write}};
/// let path = std::env::temp_dir().join("stillrate-style-example.csv");
/// let style = Style {
///     delimiter: b';',
///     decimal_comma: true,
///     preamble: vec!["# logger 7".into()],
///     header: None,
///     missing_word: "n/a".into(),
/// };
/// write(&path, &[Column::Integers(vec![1, 2]), Column::Numbers(vec![0.5, f64::NAN])], &style)?;
/// assert_eq!(std::fs::read_to_string(&path)?, "# logger 7\n1;0,5\n2;n/a\n");
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Style {
    /// The byte between fields.
    pub delimiter: u8,
    /// Write numbers with a comma.
    pub decimal_comma: bool,
    /// Lines to put first, as they are.
    pub preamble: Vec<String>,
    /// Column names to write below the preamble, if any.
    pub header: Option<Vec<String>>,
    /// What to write for a missing value.
    pub missing_word: String,
}

/// Writes columns of one length as delimited text.
///
/// # Errors
/// If the file cannot be written or the columns differ in length.
///
/// # Example
/// ```
/// use stillrate_lab::logs::{delimited::{Column, read}, writer::{Style, write}};
/// let path = std::env::temp_dir().join("stillrate-writer-example.csv");
/// let style = Style {
///     delimiter: b',',
///     decimal_comma: false,
///     preamble: Vec::new(),
///     header: Some(vec!["t_s".into(), "gx_dps".into()]),
///     missing_word: "nan".into(),
/// };
/// let columns = [Column::Numbers(vec![0.0, 0.5]), Column::Numbers(vec![1.25, f64::NAN])];
/// write(&path, &columns, &style)?;
/// assert_eq!(std::fs::read_to_string(&path)?, "t_s,gx_dps\n0.0,1.25\n0.5,nan\n");
/// assert_eq!(read(&path).unwrap().columns[0], columns[0]);
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write(path: &Path, columns: &[Column], style: &Style) -> io::Result<()> {
    let rows = columns.first().map_or(0, length);
    if columns.iter().any(|column| length(column) != rows) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "columns differ in length"));
    }
    let mut file = BufWriter::with_capacity(1 << 18, File::create(path)?);
    for line in &style.preamble {
        writeln!(file, "{line}")?;
    }
    let mut text = csv::WriterBuilder::new().has_headers(false).delimiter(style.delimiter).from_writer(file);
    if let Some(names) = &style.header {
        text.write_record(names)?;
    }
    let mut digits = ryu::Buffer::new();
    for row in 0..rows {
        for column in columns {
            match column {
                Column::Integers(values) => text.write_field(values[row].to_string())?,
                Column::Text(values) => text.write_field(&values[row])?,
                Column::Numbers(values) if values[row].is_nan() => text.write_field(&style.missing_word)?,
                Column::Numbers(values) if style.decimal_comma => {
                    text.write_field(digits.format(values[row]).replacen('.', ",", 1))?;
                }
                Column::Numbers(values) => text.write_field(digits.format(values[row]))?,
            }
        }
        text.write_record(None::<&[u8]>)?;
    }
    let file = text.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
    file.into_inner()?.sync_all()
}

fn length(column: &Column) -> usize {
    match column {
        Column::Integers(values) => values.len(),
        Column::Numbers(values) => values.len(),
        Column::Text(values) => values.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logs::delimited;

    #[test]
    fn reads_back_what_it_wrote() {
        let path = std::env::temp_dir().join(format!("stillrate-{}-writer", std::process::id()));
        let columns = [
            Column::Integers(vec![1, -2]),
            Column::Numbers(vec![0.1, 1e-300]),
            Column::Text(vec!["a;b".into(), "he said \"no\"".into()]),
        ];
        let style = Style {
            delimiter: b';',
            decimal_comma: true,
            preamble: Vec::new(),
            header: Some(vec!["i".into(), "x".into(), "w".into()]),
            missing_word: String::new(),
        };
        write(&path, &columns, &style).unwrap();
        let back = delimited::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert_eq!(back.columns, columns);
        assert!(back.dialect.decimal_comma);
    }
}
