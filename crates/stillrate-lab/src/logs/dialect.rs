//! How a delimited text file is written: delimiter, decimal comma, header, preamble.
//!
//! Found from the first part of the file. The last lines of that part tell how many fields a row has; the first line
//! with as many fields is the header (or, if it holds numbers only, the first row), and what stands before it is
//! preamble, which is kept.

/// How many bytes of a file are looked at to find its dialect.
pub(super) const SAMPLE_BYTES: usize = 256 * 1024;

/// Lines beginning with one of these are comments.
const COMMENT_MARKS: [&str; 3] = ["#", "%", "//"];

/// How a delimited text file is written.
///
/// # Example
/// ```
/// use stillrate_lab::logs::delimited::{Dialect, read};
/// let path = std::env::temp_dir().join("stillrate-dialect-example.csv");
/// std::fs::write(&path, "logger 7\nt;gx\ns;deg/s\n0,0;1,5\n0,1;1,6\n")?;
/// let Dialect { delimiter, decimal_comma, names, preamble, .. } = read(&path).unwrap().dialect;
/// assert_eq!((delimiter, decimal_comma), (b';', true));
/// assert_eq!(names, ["t [s]", "gx [deg/s]"]);
/// assert_eq!(preamble.len(), 3);
/// std::fs::remove_file(&path)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dialect {
    /// The byte between fields; a space stands for any run of blanks.
    pub delimiter: u8,
    /// Numbers are written with a comma (`1,5`).
    pub decimal_comma: bool,
    /// Lines before the first row, kept as they are (header included).
    pub preamble: Vec<String>,
    /// Column names, made up (`column_1`) when the file has none.
    pub names: Vec<String>,
    /// Whether the names come from the file.
    pub named: bool,
    /// Number of lines before the first row.
    pub lines_before_rows: usize,
}

/// Decodes UTF-8 (with or without mark), or Latin-1 when it is not UTF-8.
pub(super) fn decode(bytes: &[u8]) -> String {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    match core::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// Whether a line is a comment.
pub(super) fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    COMMENT_MARKS.iter().any(|mark| line.starts_with(mark))
}

/// A field's number; `None` if it is not one. Blank and the usual words for "no value" are NaN.
pub(super) fn number(field: &str, decimal_comma: bool) -> Option<f64> {
    let field = field.trim();
    if is_missing(field) {
        return Some(f64::NAN);
    }
    // Words such as "infinity" are numbers to the parser; "1_000" is not.
    if decimal_comma && field.contains(',') {
        return field.replacen(',', ".", 1).parse().ok();
    }
    field.parse().ok()
}

/// Whether a field says that there is no value.
pub(super) fn is_missing(field: &str) -> bool {
    field.is_empty() || ["nan", "na", "n/a", "null", "none", "-nan"].iter().any(|word| field.eq_ignore_ascii_case(word))
}

/// Splits a line into fields; quotes that begin a field protect delimiters within it.
fn split(line: &str, delimiter: u8) -> Vec<String> {
    if delimiter == b' ' {
        return line.split_whitespace().map(|field| field.trim_matches('"').to_owned()).collect();
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .from_reader(line.as_bytes());
    let mut record = csv::StringRecord::new();
    let _ = reader.read_record(&mut record);
    record.iter().map(str::to_owned).collect()
}

/// Finds the dialect of a file from its first part, which may be all of it; `None` if there is no line with a field.
pub(super) fn detect(sample: &str, complete: bool) -> Option<Dialect> {
    let mut lines: Vec<&str> = sample.lines().collect();
    if !complete && lines.len() > 1 {
        lines.pop();
    }
    let told = lines.first().and_then(|line| line.strip_prefix("sep=")).and_then(|rest| rest.bytes().next());
    let content: Vec<usize> = (usize::from(told.is_some())..lines.len())
        .filter(|index| !is_comment(lines[*index]) && !lines[*index].trim().is_empty())
        .collect();
    let tail: Vec<&str> = content.iter().rev().take(25).map(|index| lines[*index]).collect();
    let delimiter = told.unwrap_or_else(|| delimiter_of(&tail));
    let width = usual(tail.iter().map(|line| split(line, delimiter).len()))?;
    let first = *content.iter().find(|index| split(lines[**index], delimiter).len() == width)?;
    let decimal_comma = delimiter != b',' && has_decimal_comma(&tail, delimiter);
    let fields = split(lines[first], delimiter);
    let headless = fields.iter().all(|field| number(field, decimal_comma).is_some());
    let (names, named, rows_from) = if headless {
        match commented_names(&lines[..first], delimiter, width) {
            Some(names) => (names, true, first),
            None => ((1..=width).map(|index| format!("column_{index}")).collect(), false, first),
        }
    } else {
        with_units_row(fields, &lines, first, delimiter, decimal_comma)
    };
    let preamble = lines[..rows_from].iter().map(|line| (*line).to_owned()).collect();
    Some(Dialect { delimiter, decimal_comma, preamble, names: distinct(names), named, lines_before_rows: rows_from })
}

/// The delimiter that cuts most lines into one and the same number of fields.
fn delimiter_of(lines: &[&str]) -> u8 {
    // A comma comes after the others: with them it may be the decimal comma.
    let score = |delimiter: u8| {
        let widths: Vec<usize> = lines.iter().map(|line| split(line, delimiter).len()).collect();
        let width = usual(widths.iter().copied()).unwrap_or(1);
        if width < 2 { 0 } else { widths.iter().filter(|found| **found == width).count() }
    };
    let mut best = (b',', score(b','));
    for delimiter in [b'|', b'\t', b';'] {
        let found = score(delimiter);
        if found > 0 && found >= best.1 {
            best = (delimiter, found);
        }
    }
    // Blanks and tabs mixed: more numbers between blanks than fields between tabs.
    let numbers = |line: &&str| {
        let fields = split(line, b' ');
        fields.len() > split(line, b'\t').len() && fields.iter().all(|field| number(field, true).is_some())
    };
    let mixed = best.0 == b'\t' && lines.iter().all(numbers);
    if score(b' ') > 0 && (best.1 == 0 || mixed) { b' ' } else { best.0 }
}

/// The most frequent value (the first met of several).
fn usual(values: impl Iterator<Item = usize>) -> Option<usize> {
    let mut counts: Vec<(usize, usize)> = Vec::new();
    for value in values {
        match counts.iter_mut().find(|(known, _)| *known == value) {
            Some((_, count)) => *count += 1,
            None => counts.push((value, 1)),
        }
    }
    counts.iter().rev().max_by_key(|(_, count)| *count).map(|(value, _)| *value)
}

fn has_decimal_comma(lines: &[&str], delimiter: u8) -> bool {
    let fields: Vec<String> = lines.iter().flat_map(|line| split(line, delimiter)).collect();
    let commas = fields.iter().any(|field| field.contains(',') && number(field, true).is_some());
    let points = fields.iter().any(|field| field.contains('.') && number(field, false).is_some());
    commas && !points
}

/// Names from the last comment before the rows, if it has as many fields as a row.
fn commented_names(lines: &[&str], delimiter: u8, width: usize) -> Option<Vec<String>> {
    let line = lines.iter().rev().find(|line| is_comment(line))?.trim_start();
    let mark = COMMENT_MARKS.iter().find(|mark| line.starts_with(**mark))?;
    let fields = split(line.trim_start_matches(mark).trim(), delimiter);
    (fields.len() == width && fields.iter().any(|field| number(field, false).is_none())).then_some(fields)
}

/// Joins a row of units below the header (`s;deg/s`) to the names.
fn with_units_row(
    names: Vec<String>,
    lines: &[&str],
    header: usize,
    delimiter: u8,
    decimal_comma: bool,
) -> (Vec<String>, bool, usize) {
    let units = lines.get(header + 1).map(|line| split(line, delimiter)).unwrap_or_default();
    let below = lines.get(header + 2).map(|line| split(line, delimiter)).unwrap_or_default();
    let numeric = |fields: &[String]| fields.iter().filter(|f| number(f, decimal_comma).is_some()).count();
    let is_units = units.len() == names.len()
        && below.len() == names.len()
        && units.iter().all(|unit| number(unit, decimal_comma).is_none_or(f64::is_nan))
        && numeric(&below) > 0
        && units.iter().any(|unit| !unit.is_empty());
    if !is_units {
        return (names, true, header + 1);
    }
    let joined = names
        .into_iter()
        .zip(units)
        .map(|(name, unit)| {
            let unit = unit.trim_matches(['[', ']', '(', ')']);
            if unit.is_empty() { name } else { format!("{name} [{unit}]") }
        })
        .collect();
    (joined, true, header + 2)
}

/// Makes empty names and repeated names distinct.
fn distinct(names: Vec<String>) -> Vec<String> {
    let mut found: Vec<String> = Vec::with_capacity(names.len());
    for (index, name) in names.into_iter().enumerate() {
        let base = if name.is_empty() { format!("column_{}", index + 1) } else { name };
        let mut name = base.clone();
        let mut count = 2;
        while found.contains(&name) {
            name = format!("{base}_{count}");
            count += 1;
        }
        found.push(name);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decodes_utf_8_without_its_mark_and_latin_1() {
        assert_eq!(decode(b"\xef\xbb\xbfdeg/s"), "deg/s");
        assert_eq!(decode(b"\xb0/s"), "\u{b0}/s");
    }

    #[test]
    fn tells_numbers_comments_and_missing_values_apart() {
        assert!(is_comment("  # t, gx") && !is_comment("t, gx"));
        assert_eq!((number("1,5", true), number(" 2 ", false), number("x", false)), (Some(1.5), Some(2.0), None));
        assert!(number("n/a", false).unwrap().is_nan());
        assert!(is_missing("") && is_missing("NaN") && !is_missing("0"));
    }

    #[test]
    fn splits_at_delimiters_outside_quotes_and_at_any_run_of_blanks() {
        assert_eq!(split("a ;\"b;c\"", b';'), ["a", "b;c"]);
        assert_eq!(split("1   2", b' '), ["1", "2"]);
    }

    #[test]
    fn the_rows_tell_where_the_header_is() {
        let dialect = detect("logger 7\nt;gx\n0,0;1,5\n0,1;1,6\n", true).unwrap();
        assert_eq!((dialect.delimiter, dialect.decimal_comma), (b';', true));
        assert_eq!((dialect.names, dialect.lines_before_rows), (vec!["t".into(), "gx".into()], 2));
    }
}
