//! Results as CSV text, and names of their files.

use etalon_core::error::{Error, Result};
use serde::Serialize;
use std::path::Path;

/// Rows as CSV text, with the field names of `T` as header, also without rows.
pub fn table<T: Serialize + Default>(rows: &[T]) -> Result<Vec<u8>> {
    if rows.is_empty() {
        let text = table(&[T::default()])?;
        return Ok(text.split_inclusive(|b| *b == b'\n').next().unwrap_or_default().to_vec());
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = rows.iter().try_for_each(|row| writer.serialize(row)).map_err(std::io::Error::from);
    let text = written.and_then(|()| writer.into_inner().map_err(csv::IntoInnerError::into_error));
    text.map_err(|e| Error::io(Path::new("table"), e))
}

/// `name` with a hyphen for each character that file names should not have.
pub fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || "-_.+".contains(c) { c } else { '-' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_have_their_field_names_as_header() {
        #[derive(Default, Serialize)]
        struct Row {
            theta_deg: f64,
        }
        assert_eq!(table(&[Row { theta_deg: 0.5 }]).unwrap(), b"theta_deg\n0.5\n");
        assert_eq!(table::<Row>(&[]).unwrap(), b"theta_deg\n");
    }
}
