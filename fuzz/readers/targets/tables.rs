//! A table, read as that of the inputs of a run and as that of its results.

use super::importer::csv;
use super::importer::tabular::decoded;
use super::results::table::Table;

pub fn tables(data: &[u8]) {
    let text = decoded(data.to_vec());
    // An array of FMI 3, whose elements stand in one cell.
    let array = ["v[1]".to_owned(), "v[2]".to_owned()];
    let elements = |name: &str| (name == "v").then_some(&array[..]);
    match csv::Table::parse(&text, elements) {
        Ok((table, names)) => {
            assert_eq!(names.rows.len(), table.rows.len());
            assert_eq!(names.columns.len(), table.names.len());
            let whole = |row: &Vec<f64>| row.len() == table.names.len();
            assert!(table.rows.iter().all(whole));
            assert!(table.rows.iter().flatten().all(|x| x.is_finite()));
            assert!(table.rows.is_sorted_by(|a, b| a[0] <= b[0]));
            // What is written is read back, where names are names: others lose what is around them.
            let plain = |name: &String| {
                let inner = name
                    .chars()
                    .all(|c| c.is_alphanumeric() || "._".contains(c));
                inner && !name.is_empty()
            };
            if table.names.iter().all(plain) {
                let again = csv::Table::parse(&table.to_text(), |_| None);
                assert_eq!(again.expect("a table").0, table, "{text}");
            }
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
    match Table::parse(&text) {
        Ok(table) => {
            assert!(table.time.is_sorted_by(|a, b| a <= b));
            let whole = |column: &(String, Vec<f64>)| column.1.len() == table.time.len();
            assert!(table.columns.iter().all(whole), "{text}");
            assert_eq!(table.units.len(), table.columns.len(), "{text}");
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}
