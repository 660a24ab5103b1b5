//! Tables as spreadsheets and other programs write them.

use super::*;

/// Python 3.11: `[str(x) for x in …]`.
#[test]
fn numbers_are_written_as_python_writes_them() {
    for (value, expected) in [
        (0.0, "0.0"),
        (-0.0, "-0.0"),
        (1.0, "1.0"),
        (0.1, "0.1"),
        (1.0 / 3.0, "0.3333333333333333"),
        (1e-4, "0.0001"),
        (1e-5, "1e-05"),
        (1.25e-7, "1.25e-07"),
        (1e15, "1000000000000000.0"),
        (1e16, "1e+16"),
        (-1.5e300, "-1.5e+300"),
        (5e-324, "5e-324"),
    ] {
        assert_eq!(written(value), expected);
    }
}

#[test]
fn a_written_table_reads_back_to_the_same_bits() {
    let table = Table {
        names: vec!["time".into(), "a.b[1]".into()],
        rows: vec![vec![0.0, 1.0 / 3.0], vec![0.1, -2e-300], vec![0.1, 5e22]],
    };
    assert!(
        table
            .to_text()
            .starts_with("\"time\",\"a.b[1]\"\n0.0,0.3333333333333333\n")
    );
    let read = Table::parse(&table.to_text(), |_| None).map(|(table, _)| table);
    assert_eq!(read, Ok(table));
}

/// What is in a table, wherever it stands.
fn read(text: &str) -> Table {
    let read = Table::parse(text, |_| None).unwrap_or_else(|error| panic!("{text:?}: {error}"));
    read.0
}

#[test]
fn tables_of_spreadsheets_are_read_whatever_separates_their_columns() {
    let expected = read("time,a,b\n0,1,2\n0.5,-1,3\n");
    for text in [
        "time;a;b\r\n0;1;2\r\n0.5;-1;3\r\n",
        "time\ta\tb\n0\t1\t2\n0.5\t-1\t3\n",
        "\u{feff}\r\n\"time\";\"a\";\"b\"\r\n0;1;2\r\n0.5;-1;3",
    ] {
        assert_eq!(read(text), expected, "{text:?}");
    }
    // What is in quotes belongs to a name.
    let table = read("time,\"a;b;c\"\n0,1\n");
    assert_eq!(table.names, ["time", "a;b;c"]);
}

#[test]
fn a_decimal_comma_is_refused_and_a_lack_of_separators_told() {
    let told = |text: &str| {
        Table::parse(text, |_| None)
            .expect_err("faulty")
            .to_string()
    };
    for text in [
        "time;a\n0;1,5\n",
        "time\ta\n0\t1,234\n",
        "time,a\n0,\"1,5\"\n",
    ] {
        let told = told(text);
        assert!(told.starts_with("line 2, column 2 ('a'): '1,"), "{told}");
        assert!(
            told.contains("the decimal sign of these tables is a point"),
            "{told}"
        );
    }
    for text in ["time;a\n0;on\n", "time;a\n0;1,5,0\n"] {
        assert!(!told(text).contains("decimal"), "{}", told(text));
    }
    assert!(told("time a\n0 1\n").contains("by commas, semicolons or tabs"));
    assert!(!told("t,a\n0,1\n").contains("commas"));
}

#[test]
fn what_spreadsheets_add_to_a_table_is_no_part_of_it() {
    let expected = read("time,a,b\n0,1,2\n0.5,-1,3\n");
    for text in [
        "sep=;\ntime;a;b\n0;1;2\n0.5;-1;3\n",
        "\u{feff}\"sep=\t\"\r\ntime\ta\tb\r\n0\t1\t2\r\n0.5\t-1\t3\r\n",
        "SEP=,\ntime,a,b\n0,1,2\n0.5,-1,3\n",
        "time,a,b,,\n0,1,2,,\n0.5,-1,3,,\n,,,,\n",
        "Time [s],a,b\n0,1,2,\n0.5,-1,3\n",
    ] {
        assert_eq!(read(text), expected, "{text:?}");
    }
    let line = |text: &str| Table::parse(text, |_| None).expect("a table").1.line;
    assert_eq!(line("sep=;\n\ntime;a\n0;1\n"), 3);
    assert_eq!(line("time,a\n0,1\n"), 1);
    let told = |text: &str| {
        Table::parse(text, |_| None)
            .expect_err("faulty")
            .to_string()
    };
    assert_eq!(
        told("sep=;\ntime;a;a\n0;1;1\n"),
        "line 2, column 3: 'a' stands there twice"
    );
    assert_eq!(
        told("time,a\n0,1,2\n"),
        "line 2: 3 values, but line 1 names 2 columns"
    );
    // Milliseconds must not become seconds.
    assert!(told("time [ms],a\n0,1\n").contains("must be 'time', not 'time [ms]'"));
}

#[test]
fn the_column_of_an_array_has_its_elements_in_each_cell() {
    let elements = ["v.x".to_owned(), "v.y".to_owned()];
    let parse = |text: &str| Table::parse(text, |name| (name == "v").then_some(&elements[..]));
    let (table, places) = parse("time,v,b\n0,1 -2,3\n1,\"true  2e-1\",4\n").expect("a table");
    assert_eq!(table, read("time,v.x,v.y,b\n0,1,-2,3\n1,1,0.2,4\n"),);
    assert_eq!(places.columns, [1, 2, 2, 3]);
    for (text, told) in [
        (
            "time,v\n0,1 2\n1,1 2 3\n",
            "line 3, column 2: 3 numbers, but 'v' is an array of 2; they stand with spaces \
             between them",
        ),
        (
            "time,v\n0,1 x\n",
            "line 2, column 2 ('v'): 'x' is no finite number",
        ),
        (
            "time,v,v.y\n0,1 2,3\n",
            "line 1, column 3: 'v.y' stands there twice",
        ),
    ] {
        let found = parse(text).expect_err("faulty").to_string();
        assert!(found.starts_with(told), "{found}");
    }
    // What is no array has no spaces in it.
    let told = Table::parse("time,a\n0,1 000\n", |_| None).expect_err("faulty");
    assert!(told.to_string().contains("thousands"), "{told}");
}

#[test]
fn spaces_quotes_line_ends_and_booleans_of_others_are_read() {
    let text = "\u{feff}\"time\", \"on\" ,x\r\n0,True,1\r\n1,false,+2.5E1\r\n\r\n";
    let (table, _) = Table::parse(text, |_| None).expect("legal");
    assert_eq!(table.names, ["time", "on", "x"]);
    assert_eq!(table.rows, [[0.0, 1.0, 1.0], [1.0, 0.0, 25.0]]);
}

#[test]
fn faults_are_reported_with_line_and_column() {
    let message = |text: &str| {
        Table::parse(text, |_| None)
            .expect_err("faulty")
            .to_string()
    };
    assert!(message("").contains("empty"));
    assert!(message("PK\u{3}\u{4}\0\0").contains("no text"));
    assert_eq!(
        message("t,x\n0,1"),
        "line 1: the first column must be 'time', not 't'"
    );
    assert_eq!(
        message("time,x,x\n0,1,1"),
        "line 1, column 3: 'x' stands there twice"
    );
    assert_eq!(
        message("time,x\n\n0,1\r\n  \n1"),
        "line 5: 1 values, but line 1 names 2 columns"
    );
    assert_eq!(
        message("time,x\n0,1\n1,nan"),
        "line 3, column 2 ('x'): 'nan' is no finite number"
    );
    assert_eq!(
        message("time,x\n1,1\n0.5,2"),
        "line 3: time 0.5 s comes after 1 s; times must not go back"
    );
    assert!(message("time,x\n").contains("no values"));
}
