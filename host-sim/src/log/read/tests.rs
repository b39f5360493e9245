//! The bar: every wrong file is one screen that says file, line, column, value and remedy.

use super::*;
use std::io::Write;

fn read_bytes(name: &str, content: &[u8], options: &ReadOptions) -> Result<Log, Diagnostic> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, content).unwrap();
    Log::read(&path, options)
}

fn read_text(name: &str, content: &str, options: &ReadOptions) -> Result<Log, Diagnostic> {
    read_bytes(name, content.as_bytes(), options)
}

fn strict(name: &str, content: &str) -> Result<Log, Diagnostic> {
    read_text(name, content, &ReadOptions::default())
}

fn skipping(name: &str, content: &str) -> Result<Log, Diagnostic> {
    let options = ReadOptions {
        skip_bad_rows: true,
        ..ReadOptions::default()
    };
    read_text(name, content, &options)
}

/// Twenty good rows with row `at` (from 0) replaced.
fn table(at: usize, row: &str) -> String {
    let mut text = "t_s,x_m,f_n\n".to_string();
    for index in 0..20 {
        if index == at {
            text.push_str(row);
        } else {
            text.push_str(&format!("{:.3},0.001,0.5", index as f64 * 1e-3));
        }
        text.push('\n');
    }
    text
}

#[test]
fn a_bad_value_is_named_with_line_column_value_and_remedy() {
    for (name, row, column, value, what) in [
        ("text", "0.005,0.001,abc", "column f_n", "abc", "text"),
        ("nan", "0.005,NaN,0.5", "column x_m", "NaN", "not finite"),
        (
            "inf",
            "0.005,0.001,-inf",
            "column f_n",
            "-inf",
            "not finite",
        ),
        ("empty", "0.005,,0.5", "column x_m", "", "no value"),
        (
            "over",
            "0.005,0.001,9.9E37",
            "column f_n",
            "9.9E37",
            "out of range",
        ),
        (
            "back",
            "0.003,0.001,0.5",
            "column t_s",
            "0.003",
            "from 0.004 s to 0.003 s",
        ),
    ] {
        let error = strict(name, &table(5, row)).unwrap_err();
        assert_eq!(error.line, Some(7), "{error}");
        assert_eq!(error.field.as_deref(), Some(column), "{error}");
        assert_eq!(error.value.as_deref(), Some(value), "{error}");
        assert!(error.what.contains(what), "{error}");
        assert!(error.path.is_some() && error.remedy.is_some(), "{error}");
        assert!(error.to_string().lines().count() < 10, "{error}");
        let excerpt = error.excerpt.as_ref().unwrap();
        assert_eq!(excerpt.text, row);
        assert_eq!(
            excerpt.text[excerpt.marked.clone()].trim_end_matches(','),
            value
        );
    }
}

#[test]
fn lines_are_counted_right_after_blank_lines_comments_and_windows_line_ends() {
    let text = table(5, "0.005,0.001,abc")
        .replace("0.002,", "\n# a comment\n\n0.002,")
        .replace('\n', "\r\n");
    let error = strict("crlf", &text).unwrap_err();
    assert_eq!(error.line, Some(10), "{error}");
    assert_eq!(error.excerpt.as_ref().unwrap().text, "0.005,0.001,abc");
}

#[test]
fn a_ragged_row_is_named() {
    let error = strict("ragged", &table(19, "0.019,0.0")).unwrap_err();
    assert_eq!(error.line, Some(21), "{error}");
    assert!(error.what.contains("2 values in a row, 3 names"), "{error}");
}

#[test]
fn rows_that_end_with_a_delimiter_are_whole() {
    let text = table(99, "").replace("0.5\n", "0.5,\n");
    assert_eq!(strict("closed", &text).unwrap().len(), 20);
}

#[test]
fn a_row_of_units_is_read_over() {
    let text = table(99, "").replace("f_n\n", "f_n\n(s),(m),(N)\n");
    assert_eq!(strict("units-row", &text).unwrap().len(), 20);
}

#[test]
fn bad_rows_are_left_out_and_counted_when_asked_for() {
    let mut text = table(5, "0.005,NaN,0.5");
    text.push_str("0.020,0.0");
    let log = skipping("skipped", &text).unwrap();
    assert_eq!(log.len(), 19);
    assert_eq!(log.notes, ["2 bad rows left out, the first at line 7"]);
}

#[test]
fn text_is_an_error_even_when_bad_rows_are_left_out() {
    assert!(skipping("text-skip", &table(5, "0.005,abc,0.5")).is_err());
}

#[test]
fn too_many_bad_rows_are_an_error_that_shows_the_first() {
    let text = table(0, "0,0,0").replace("0.5\n", "NaN\n");
    let error = skipping("many", &text).unwrap_err();
    assert!(
        error.what.starts_with("19 of 20 rows are unusable"),
        "{error}"
    );
    assert_eq!(error.line, Some(3));
}

#[test]
fn a_repeated_stamp_is_dropped_and_counted() {
    let log = strict("repeated", &table(5, "0.004,0.001,0.7")).unwrap();
    assert_eq!(log.len(), 19);
    assert!(
        log.notes[0].starts_with("1 sample left out"),
        "{:?}",
        log.notes
    );
    assert!(!log.force_n.contains(&0.7));
}

#[test]
fn a_clock_that_repeats_too_often_and_unevenly_is_an_error() {
    let stamp = |i: u32| if i < 20 { i / 2 } else { 10 + (i - 20) / 10 };
    let rows: String = (0..40)
        .map(|i| format!("{:.3},0,0\n", f64::from(stamp(i)) * 1e-3))
        .collect();
    let error = strict("coarse", &format!("t_s,x_m,f_n\n{rows}")).unwrap_err();
    assert!(
        error.what.starts_with("28 of 40 time stamps repeat"),
        "{error}"
    );
    assert!(error.remedy.as_ref().unwrap().contains("--rate"));
}

#[test]
fn a_second_recording_in_one_file_is_recognised() {
    let text = format!(
        "{}{}",
        table(99, ""),
        table(99, "").trim_start_matches("t_s,x_m,f_n\n")
    );
    let error = strict("twice", &text).unwrap_err();
    assert!(error.remedy.as_ref().unwrap().contains("second recording"));
}

#[test]
fn a_header_alone_and_too_few_samples_are_errors() {
    let error = strict("header", "t_s,x_m,f_n\n").unwrap_err();
    assert!(error.what.contains("no row"), "{error}");
    let error = strict("few", "t_s,x_m,f_n\n0,0,0\n1,0,0\n").unwrap_err();
    assert!(error.what.contains("2 samples"), "{error}");
}

#[test]
fn a_missing_file_and_a_folder_are_errors() {
    let options = ReadOptions::default();
    let error = Log::read(Path::new("no/such/log.csv"), &options).unwrap_err();
    assert_eq!(error.remedy.as_deref(), Some("check the path"));
    assert!(Log::read(&std::env::temp_dir(), &options).is_err());
}

#[test]
fn european_numbers_read_as_numbers() {
    let rows: String = (0..12).map(|i| format!("0,{i:03};1,5;-0,25\n")).collect();
    let log = strict("comma", &format!("t_s;x_m;f_n\n{rows}")).unwrap();
    assert_eq!(log.time_s[11], 0.011);
    assert_eq!(log.force_n[0], -0.25);
    assert!(log.notes[0].contains("decimal points"));
}

#[test]
fn other_peoples_columns_and_units_become_si() {
    let rows: String = (0..12).map(|i| format!("{i}\t-3.0\thold\t2.5\n")).collect();
    let text = format!("Time [ms]\tFz (N)\tphase\tpos_mm\n{rows}");
    let options = ReadOptions {
        columns: "t=Time [ms]*1e-3,x=pos_mm*1e-3,f=-Fz (N)".parse().unwrap(),
        ..ReadOptions::default()
    };
    let log = read_text("units", &text, &options).unwrap();
    assert_eq!(
        (log.time_s[11], log.position_m[0], log.force_n[0]),
        (0.011, 0.0025, 3.0)
    );
    assert!(log.extra("phase").unwrap()[0].is_nan());
    assert!(log.notes[0].starts_with("read as: time from `Time [ms]` × 0.001"));
    assert!(log.notes[1].contains("`phase` holds text in 12 rows"));
}

#[test]
fn a_zipped_log_reads_the_same_and_a_truncated_one_is_an_error() {
    let text = table(99, "");
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    let zipped = encoder.finish().unwrap();
    let options = ReadOptions::default();
    let log = read_bytes("whole.csv.gz", &zipped, &options).unwrap();
    assert_eq!(log.time_s, strict("unzipped", &text).unwrap().time_s);
    let cut = &zipped[..zipped.len() - 12];
    let error = read_bytes("cut.csv.gz", cut, &options).unwrap_err();
    assert!(
        error
            .remedy
            .as_ref()
            .unwrap()
            .contains("damaged or cut off")
    );
}

#[test]
fn extracts_of_measured_logs_read() {
    // Three rows each of a linear drive, an AFM and a foam tester, repeated with growing time.
    for (name, header, row, extra) in [
        (
            "emps",
            "t_s,x_m,f_n,u_v,xref_m",
            "0.00000767,89.74749,2.553224,0.00010782",
            "xref_m",
        ),
        (
            "afm",
            "t_s,x_m,f_n,phase",
            "1.0001000e-08,-1.41989e-09,0",
            "phase",
        ),
        (
            "foam",
            "t_s,x_m,f_n,phase,temp_c",
            "0.000627040,2.874890,1,30.00",
            "temp_c",
        ),
    ] {
        let rows: String = (0..30)
            .map(|i| format!("{:.4},{row}\n", f64::from(i) * 2e-4))
            .collect();
        let log = strict(name, &format!("{header}\n{rows}")).unwrap();
        assert_eq!(log.rate_hz(), 5000.0);
        assert!(log.extra(extra).is_some() && log.notes.is_empty());
    }
}
