//! What FMI 3 lists as arrays.

use super::*;

fn listed(description: &Description, settings: &str) -> (Vec<Variable>, Vec<Entry>) {
    let model = model(description, settings);
    let table = table(&model).expect("no clash");
    let entries = entries(&model, &table).expect("no clash");
    (table, entries)
}

#[test]
fn without_arrays_each_row_is_an_entry() {
    let (table, entries) = listed(&cart(), "[fmu]\narrays = \"none\"\n");
    assert_eq!(entries.len(), table.len());
    for (entry, row) in entries.iter().zip(&table) {
        assert_eq!(
            (&entry.name, entry.value_reference),
            (&row.name, row.value_reference)
        );
        assert!(entry.shape.is_empty());
    }
}

#[test]
fn vectors_have_the_rows_of_their_elements_and_every_row_is_in_one_entry() {
    for arrays in ["vectors", "all"] {
        let settings =
            format!("[fmu]\narrays = \"{arrays}\"\n[[external_wrench]]\nlink = \"fork\"\n");
        let (table, entries) = listed(&cart(), &settings);
        let mut seen = vec![0; table.len()];
        for entry in &entries {
            assert_eq!(
                entry.rows.len(),
                entry.shape.iter().product::<u32>().max(1) as usize
            );
            let first = &table[entry.rows[0] as usize];
            for row in &entry.rows {
                let row = &table[*row as usize];
                assert_eq!(
                    (row.kind, row.stepped),
                    (first.kind, first.stepped),
                    "{}",
                    entry.name
                );
                if entry.value_reference < time_reference(&table) {
                    seen[row.value_reference as usize] += 1;
                }
            }
        }
        let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
        assert!(names.contains(&"base.position") && !names.contains(&"base.position.x"));
        assert_eq!(
            names.contains(&"ext.fork.force"),
            arrays == "all",
            "{names:?}"
        );
        // Commands that are gathered are in no other entry.
        let gathered = |name: &str| arrays == "all" && name.starts_with("cmd.");
        for (row, seen) in table.iter().zip(seen) {
            assert_eq!(seen, i32::from(!gathered(&row.name)), "{}", row.name);
        }
    }
}

#[test]
fn vectors_over_joints_follow_the_order_of_the_joints() {
    let (table, entries) = listed(&cart(), "[fmu]\narrays = \"all\"\n");
    let rows = |name: &str| -> Vec<&str> {
        let entry = entries.iter().find(|entry| entry.name == name);
        let entry = entry.unwrap_or_else(|| panic!("no {name}"));
        let rows = entry.rows.iter();
        rows.map(|row| table[*row as usize].name.as_str()).collect()
    };
    assert_eq!(
        rows("robot.joint.position"),
        [
            "joint.left_wheel.position",
            "joint.lift.position",
            "joint.grip.position"
        ]
    );
    assert_eq!(rows("robot.cmd.velocity"), ["cmd.left_wheel.velocity"]);
    assert_eq!(
        rows("robot.cmd.max_effort"),
        ["cmd.left_wheel.max_effort", "cmd.lift.max_effort"]
    );
}
