//! Delimited text (CSV, TSV and kin) into typed columns.
//!
//! The file is read twice as a stream: once to learn what each column holds (integers, numbers, text), once to store
//! it, so that a column of integers (time stamps in nanoseconds) stays exact and text comes back as it was. Memory is
//! bounded by the columns; a file of zeros or without line ends is refused early.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use super::dialect;
pub use super::dialect::Dialect;
use super::guarded::Guarded;

/// What a column holds.
///
/// # Example
/// ```
/// use stillrate_lab::logs::delimited::{Column, read};
/// let path = std::env::temp_dir().join("stillrate-column-example.csv");
/// std::fs::write(&path, "stamp_ns,gx\n1700000000123456789,0.5\n1700000000133456789,\n")?;
/// let columns = read(&path).unwrap().columns;
/// // Not one nanosecond is lost, as it would be in a number of 53 bits.
/// assert_eq!(columns[0], Column::Integers(vec![1_700_000_000_123_456_789, 1_700_000_000_133_456_789]));
/// assert!(matches!(&columns[1], Column::Numbers(gx) if gx[1].is_nan()));
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Whole numbers, none missing.
    Integers(Vec<i64>),
    /// Numbers; a missing one is NaN.
    Numbers(Vec<f64>),
    /// Anything else.
    Text(Vec<String>),
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Integers,
    Numbers,
    Text,
}

/// A table read from text.
///
/// # Example
/// ```
/// use stillrate_lab::logs::delimited::{Table, read};
/// let path = std::env::temp_dir().join("stillrate-table-example.tsv");
/// std::fs::write(&path, "t_s\tgx_dps\n0.0\t0.5\n0.1\tn/a\n")?;
/// let Table { dialect, columns, missing_word } = read(&path).unwrap();
/// assert_eq!((dialect.names.len(), columns.len()), (2, 2));
/// assert_eq!(missing_word.as_deref(), Some("n/a")); // written again where a value is missing
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Table {
    /// How the file is written.
    pub dialect: Dialect,
    /// One column a name.
    pub columns: Vec<Column>,
    /// The word that stands where a value is missing, if one is.
    pub missing_word: Option<String>,
}

/// Why a file cannot be read.
///
/// # Example
/// ```
/// use stillrate_lab::logs::delimited::{ReadError, read};
/// let path = std::env::temp_dir().join("stillrate-error-example.csv");
/// std::fs::write(&path, "t,gx\n0,1\n1,2\n2\n")?;
/// let Err(ReadError::Malformed(reason)) = read(&path) else { panic!("the last line is too short") };
/// assert!(reason.starts_with("line 4 has 1 field where 2 are expected"));
/// std::fs::remove_file(&path)?;
/// assert!(matches!(read(&path), Err(ReadError::Io(_))));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub enum ReadError {
    /// The file cannot be opened or read.
    Io(io::Error),
    /// The file is not a table; the text says which line and what was found.
    Malformed(String),
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

fn malformed<T>(text: impl Into<String>) -> Result<T, ReadError> {
    Err(ReadError::Malformed(text.into()))
}

/// Reads a table from a file of delimited text.
///
/// # Errors
/// [`ReadError`] if the file cannot be read, is empty, binary, ragged, or has no row.
///
/// # Example
/// ```
/// use stillrate_lab::logs::delimited::{Column, read};
/// let path = std::env::temp_dir().join("stillrate-read-example.csv");
/// std::fs::write(&path, "t_ns,gx,note\n1,0.5,a\n2,,b\n")?;
/// let table = read(&path).unwrap();
/// assert_eq!(table.columns[0], Column::Integers(vec![1, 2]));
/// assert_eq!(table.columns[2], Column::Text(vec!["a".into(), "b".into()]));
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn read(path: &Path) -> Result<Table, ReadError> {
    let mut sample = Vec::new();
    File::open(path)?.take(dialect::SAMPLE_BYTES as u64).read_to_end(&mut sample)?;
    if sample.is_empty() {
        return malformed("the file is empty");
    }
    if sample.starts_with(b"\xff\xfe") || sample.starts_with(b"\xfe\xff") {
        return malformed("UTF-16 text: save the table as UTF-8");
    }
    if let Some(position) = sample.iter().position(|byte| *byte == 0) {
        return malformed(format!("byte {position} is zero: binary or half-written, no table of text"));
    }
    let complete = sample.len() < dialect::SAMPLE_BYTES;
    let Some(dialect) = dialect::detect(&dialect::decode(&sample), complete) else {
        return malformed("no line with values in it");
    };
    let mut kinds = vec![Kind::Integers; dialect.names.len()];
    let mut missing_word: Option<String> = None;
    let rows = each_row(path, &dialect, |fields| {
        for (kind, field) in kinds.iter_mut().zip(fields) {
            if dialect::is_missing(field) && missing_word.is_none() {
                missing_word = Some(field.clone());
            }
            *kind = (*kind).max(kind_of(field, dialect.decimal_comma, *kind));
        }
    })?;
    if rows == 0 {
        return malformed("no samples: nothing below the header");
    }
    let mut columns: Vec<Column> = kinds
        .iter()
        .map(|kind| match kind {
            Kind::Integers => Column::Integers(Vec::with_capacity(rows)),
            Kind::Numbers => Column::Numbers(Vec::with_capacity(rows)),
            Kind::Text => Column::Text(Vec::with_capacity(rows)),
        })
        .collect();
    each_row(path, &dialect, |fields| {
        for (column, field) in columns.iter_mut().zip(fields) {
            match column {
                Column::Integers(values) => values.push(field.parse().unwrap_or(0)),
                Column::Numbers(values) => {
                    values.push(dialect::number(field, dialect.decimal_comma).unwrap_or(f64::NAN));
                }
                Column::Text(values) => values.push(field.clone()),
            }
        }
    })?;
    Ok(Table { dialect, columns, missing_word })
}

fn kind_of(field: &str, decimal_comma: bool, so_far: Kind) -> Kind {
    if so_far == Kind::Text {
        Kind::Text
    } else if field.parse::<i64>().is_ok() {
        Kind::Integers
    } else if dialect::number(field, decimal_comma).is_some() {
        Kind::Numbers
    } else {
        Kind::Text
    }
}

/// Calls `visit` with the fields of every row; returns how many there were.
fn each_row(path: &Path, dialect: &Dialect, mut visit: impl FnMut(&[String])) -> Result<usize, ReadError> {
    let mut file = BufReader::with_capacity(1 << 18, File::open(path)?);
    for _ in 0..dialect.lines_before_rows {
        file.read_until(b'\n', &mut Vec::new())?;
    }
    let blanks = dialect.delimiter == b' ';
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(if blanks { b'\t' } else { dialect.delimiter })
        .trim(csv::Trim::All)
        .from_reader(Guarded::new(file, 1 + dialect.lines_before_rows, blanks));
    let mut record = csv::ByteRecord::new();
    let (width, mut rows) = (dialect.names.len(), 0_usize);
    let mut fields = vec![String::new(); width];
    loop {
        match reader.read_byte_record(&mut record) {
            Ok(true) => {}
            Ok(false) => return Ok(rows),
            Err(error) => return malformed(reason(error)),
        }
        if record.get(0).is_some_and(|first| dialect::is_comment(&dialect::decode(first))) {
            continue;
        }
        let trailing = record.len() == width + 1 && record[width].is_empty();
        if record.len() != width && !trailing {
            let line = dialect.lines_before_rows as u64 + record.position().map_or(0, csv::Position::line);
            let (found, plural) = (record.len(), if record.len() == 1 { "" } else { "s" });
            return malformed(format!(
                "line {line} has {found} field{plural} where {width} are expected: complete or delete that line"
            ));
        }
        for (field, bytes) in fields.iter_mut().zip(&record) {
            field.clear();
            match core::str::from_utf8(bytes) {
                Ok(text) => field.push_str(text),
                Err(_) => field.push_str(&dialect::decode(bytes)),
            }
        }
        visit(&fields);
        rows += 1;
    }
}

fn reason(error: csv::Error) -> String {
    match error.into_kind() {
        csv::ErrorKind::Io(error) => error.to_string(),
        other => format!("not a table of text ({other:?})"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(name: &str, text: &[u8]) -> Result<Table, ReadError> {
        let path = std::env::temp_dir().join(format!("stillrate-{}-{name}", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let found = read(&path);
        std::fs::remove_file(&path).unwrap();
        found
    }

    #[test]
    fn keeps_whole_numbers_exact_and_text_as_it_is() {
        let found =
            table("kinds", b"stamp,g,word\n1700000000123456789,0.5,a b\n1700000000133456789,,\"c,d\"\n").unwrap();
        assert_eq!(found.columns[0], Column::Integers(vec![1_700_000_000_123_456_789, 1_700_000_000_133_456_789]));
        assert!(matches!(&found.columns[1], Column::Numbers(v) if v[0] == 0.5 && v[1].is_nan()));
        assert_eq!(found.columns[2], Column::Text(vec!["a b".into(), "c,d".into()]));
        assert_eq!(found.missing_word.as_deref(), Some(""));
    }

    #[test]
    fn reads_decimal_commas_between_semicolons_and_a_row_of_units() {
        let found = table("comma", b"t;g\r\ns;deg/s\r\n0;1,5\r\n0,01;-2,25\r\n").unwrap();
        assert_eq!(found.dialect.names, ["t [s]", "g [deg/s]"]);
        assert_eq!(found.columns[1], Column::Numbers(vec![1.5, -2.25]));
    }

    #[test]
    fn takes_names_from_a_comment_and_blanks_as_delimiter() {
        let found = table("blanks", b"# made by a logger\n# t_s gx gy\n  0.0   1 2\n 0.1  3    4 \n").unwrap();
        assert_eq!(found.dialect.names, ["t_s", "gx", "gy"]);
        assert_eq!(found.columns[2], Column::Integers(vec![2, 4]));
    }

    #[test]
    fn names_the_line_that_is_too_short() {
        let text = b"a,b,c\n1,2,3\n4,5,6\n7,8\n9,10,11\n";
        let Err(ReadError::Malformed(reason)) = table("ragged", text) else { panic!("read a ragged table") };
        assert!(reason.starts_with("line 4 has 2 fields where 3 are expected"), "{reason}");
    }

    #[test]
    fn refuses_zeros_however_late_they_come() {
        let mut text = b"a,b\n".to_vec();
        text.extend(b"1,2\n".repeat(100_000));
        text.extend([0; 4096]);
        let Err(ReadError::Malformed(reason)) = table("zeros", &text) else { panic!("read zeros") };
        assert!(reason.starts_with("line 100002 holds binary zeros"), "{reason}");
    }
}
