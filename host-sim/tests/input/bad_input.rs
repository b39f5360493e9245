//! For every wrong file and every wrong argument the command prints one screen with file, line, column,
//! value and remedy, exits with status 2, and writes nothing.

use crate::common::{Folder, MODEL, complained, csv, flowing, press, said};
use std::process::{Output, Stdio};

/// A screen: lines and columns.
const LINES: usize = 12;
const COLUMNS: usize = 100;

/// A good log with line 17 replaced.
fn with_line_17(line: &str) -> String {
    let good = csv(press());
    let lines = good.lines().enumerate();
    lines
        .map(|(index, old)| format!("{}\n", if index == 16 { line } else { old }))
        .collect()
}

/// Asserts status 2, at most one screen with all these words, and nothing on standard output.
fn assert_refused(case: &str, output: &Output, words: &[&str]) {
    let text = complained(output);
    assert_eq!(output.status.code(), Some(2), "{case}: {text}");
    assert_eq!(said(output), "", "{case}");
    assert!(text.starts_with("error: "), "{case}: {text}");
    assert!(text.lines().count() <= LINES, "{case}: {text}");
    let widest = text.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(COLUMNS), "{case}: {text}");
    let text = flowing(&text);
    for word in words {
        assert!(text.contains(word), "{case}: no `{word}` in {text}");
    }
}

type Case<'a> = (&'a str, String, &'a [&'a str]);

#[rustfmt::skip]
fn wrong_logs() -> Vec<Case<'static>> {
    let columns = |header: &str| csv(press()).replacen("t_s,x_m,f_n", header, 1);
    let first = |count: usize| csv(press().into_iter().take(count));
    let twice = csv(press()) + csv(press()).split_once('\n').unwrap().1;
    let jump = csv(press()) + "1700000000.5,0,0\n";
    let coarse = csv(press().into_iter().map(|[t, x, f]| [((t * t * 100.0).floor() / 100.0), x, f]));
    let many = (0..400).map(|i| format!("channel_{i}_of_the_rig")).collect::<Vec<_>>().join(",");
    vec![
        // what is wrong, the file, what the message says
        ("empty",              String::new(),                    &["file is empty", "log.csv", "remedy: give a CSV file"]),
        ("blank",              " \n\n".into(),                   &["file is empty", "log.csv", "remedy:"]),
        ("header only",        first(0),                         &["no row of numbers", "log.csv:1", "t_s,x_m,f_n", "remedy: record again"]),
        ("no header",          columns("0,0,0"),                 &["not the names of the columns", "log.csv:1", "0,0,0", "remedy: put a header above it: t_s,x_m,f_n"]),
        ("comments only",      "# a\n# b\n".into(),              &["nothing but comments", "log.csv", "remedy:"]),
        ("missing column",     columns("t_s,x_m,load"),          &["no column `f_n` for the force in newtons", "log.csv:1, column f_n", "`load`", "--columns 't=t_s,x=x_m,f=load'"]),
        ("misspelt column",    columns("t_s,x_m,fn"),            &["no column `f_n`", "log.csv:1", "nearest name is `fn`", "remedy:"]),
        ("two columns only",   "t_s,x_m\n0,0\n".into(),          &["no column `f_n`", "log.csv:1", "`t_s`, `x_m`", "remedy:"]),
        ("400 other columns",  many,                             &["no column `t_s`", "log.csv:1", "more", "remedy:"]),
        ("one name twice",     columns("t_s,f_n,f_n"),           &["no column `x_m`", "log.csv:1"]),
        ("duplicated column",  "t_s,x_m,f_n,x_m\n0,0,0,0\n".into(), &["two columns have the same name", "log.csv:1, column x_m", "remedy: give the number", "or rename one"]),
        ("text in a number",   with_line_17("0.015,-0.001,abc"), &["text where a number should be", "log.csv:17, column f_n", "value: `abc`", "remedy: write the force in newtons"]),
        ("NaN",                with_line_17("0.015,nan,0"),      &["not finite", "log.csv:17, column x_m", "value: `nan`", "remedy: --skip-bad-rows"]),
        ("over range",         with_line_17("0.015,0,9.9E37"),   &["no reading", "log.csv:17, column f_n", "value: `9.9E37`", "remedy: --skip-bad-rows"]),
        ("infinity",           with_line_17("0.015,0,-inf"),     &["not finite", "log.csv:17, column f_n", "value: `-inf`", "remedy: --skip-bad-rows"]),
        ("empty cell",         with_line_17("0.015,,0"),         &["no value", "log.csv:17, column x_m", "value: nothing", "remedy: --skip-bad-rows"]),
        ("ragged row",         with_line_17("0.015,-0.001"),     &["2 values in a row, 3 names in the header", "log.csv:17", "remedy: complete the row"]),
        ("long row",           with_line_17("0.015,-1,0,4,5"),   &["5 values in a row, 3 names in the header", "log.csv:17", "remedy: complete the row"]),
        ("decimal commas",     with_line_17("0,015,-0,001,0,1"), &["6 values in a row, 3 names in the header", "log.csv:17", "remedy: decimal commas need semicolons"]),
        ("backward time",      with_line_17("0.003,-0.001,0"),   &["time runs backward, from 0.014 s to 0.003 s", "log.csv:17, column t_s", "value: `0.003`", "remedy: sort"]),
        ("two recordings",     twice,                            &["time runs backward", "log.csv:2002, column t_s", "remedy: a second recording", "--trace-column 't_s'", "--segment-column 't_s'"]),
        ("a jump in time",     jump,                             &["too many samples", "log.csv", "value: `1700000000.5`", "from 1.999 to", "remedy: split the log at the gap"]),
        ("coarse clock",       coarse,                           &["time stamps repeat the one before, and not evenly", "log.csv:3, column t_s", "--rate HZ", "record the time with more digits"]),
        ("five samples",       first(5),                         &["5 samples, fewer than 10", "log.csv", "remedy: record longer"]),
        ("shorter than filter", first(24),                       &["24 samples: the filter takes 17", "log.csv", "value: `24`", "remedy: record longer"]),
        ("JSON",               "{\"t_s\": [0]}\n".into(),        &["this is a JSON file", "log.csv", "remedy: give a CSV file"]),
        ("HTML",               "<!DOCTYPE html>\n<p>404\n".into(), &["this is an HTML or XML page", "log.csv", "remedy: give a CSV file"]),
        ("a model",            MODEL.into(),                     &["this is a TOML file", "log.csv", "remedy: give a CSV file"]),
        ("binary",             "\u{7}\u{0}\u{1}".repeat(99),     &["this is a binary file", "log.csv", "remedy: give a CSV file"]),
        ("spreadsheet",        "PK\u{3}\u{4}....".into(),        &["a spreadsheet (xlsx)", "log.csv", "remedy: give a CSV file"]),
        ("cut off gzip",       "gzip".into(),                    &["cannot read the file", "log.csv", "remedy: the compressed file is damaged"]),
    ]
}

#[test]
fn every_wrong_log_is_refused_on_one_screen_by_estimate_and_check() {
    for (case, content, words) in wrong_logs() {
        let folder = Folder::with("log.csv", &content);
        if case == "cut off gzip" {
            folder.write("log.csv", gzip(&csv(press())));
        }
        let estimate = folder.palpate("estimate log.csv --out out");
        assert_refused(case, &estimate, words);
        assert!(!folder.path("out").exists(), "{case}: something is written");
        // The same file, the same words.
        let check = folder.palpate("check log.csv");
        assert_eq!(complained(&check), complained(&estimate), "{case}");
        assert_refused(case, &check, words);
    }
}

/// The first half of a gzip file.
fn gzip(text: &str) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    let whole = encoder.finish().unwrap();
    whole[..whole.len() / 2].to_vec()
}

#[test]
fn rows_that_are_left_out_on_request_are_counted_and_too_many_are_refused() {
    let folder = Folder::with("log.csv", with_line_17("0.015,nan,0"));
    let done = folder.palpate("estimate log.csv --skip-bad-rows");
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    assert!(said(&done).contains("1 bad row left out, the first at line 17"));
    let mut third = csv(press());
    third.push_str(&"2.5,nan,0\n".repeat(1000));
    folder.write("log.csv", third);
    let refused = folder.palpate("check log.csv --skip-bad-rows");
    let words = [
        "1000 of 3000 rows are unusable",
        "log.csv:2002",
        "repair the recording",
    ];
    assert_refused("a third is bad", &refused, &words);
}

#[rustfmt::skip]
const WRONG_TOML: [(&str, &str, &str, &[&str]); 19] = [
    // the file, what is in it, the verb that reads it, what the message says
    ("unknown key",        "[environment]\nlaw = \"hunt_crossley\"\nstifness = 1.0\n", MODEL_VERB,  &["unknown key `stifness` in `environment`", "f.toml:3, key environment.stifness", "remedy: write `stiffness`"]),
    ("unknown law",        "[environment]\nlaw = \"hunt_crosley\"\n",                  MODEL_VERB,  &["f.toml:2, key environment.law", "`hunt_crosley`", "remedy:", "`hunt_crossley`"]),
    ("negative",           "[environment]\nlaw = \"hunt_crossley\"\nstiffness = -1\n", MODEL_VERB,  &["outside its bounds", "f.toml:3, key environment.stiffness", "value: `-1`", "remedy: `stiffness` is"]),
    ("NaN",                "[environment]\nlaw = \"hunt_crossley\"\nstiffness = nan\n", MODEL_VERB, &["outside its bounds", "f.toml:3, key environment.stiffness", "value: `nan`", "remedy:"]),
    ("text in a number",   "[environment]\nlaw = \"hunt_crossley\"\nstiffness = \"soft\"\n", MODEL_VERB, &["a string where something else should be", "f.toml:3, key environment.stiffness", "value: `soft`", "remedy: `stiffness` is"]),
    ("missing key",        "[environment]\nlaw = \"hunt_crossley\"\n",                 MODEL_VERB,  &["is missing", "f.toml:1, key environment.", "remedy: add"]),
    ("unknown table",      "[environment]\nlaw = \"free\"\n[sensor]\n",                MODEL_VERB,  &["unknown key `sensor`", "f.toml:3", "remedy: write `sensors`"]),
    ("no environment",     "# nothing\n",                                              MODEL_VERB,  &["no [environment]", "f.toml", "remedy: write [environment]"]),
    ("no TOML",            "[environment\n",                                           MODEL_VERB,  &["not TOML", "f.toml:1", "remedy: a table is [name]"]),
    ("a log",              "t_s,x_m,f_n\n0,1,2\n",                                     MODEL_VERB,  &["this is a table, such as a log, not TOML", "f.toml:1", "remedy: a table is [name]"]),
    ("JSON",               "{\"law\": 1}\n",                                           MODEL_VERB,  &["this is a JSON file, not TOML", "f.toml:1", "remedy: a table is [name]"]),
    ("unknown kind",       "[[segment]]\nkind = \"sinus\"\n",                          MOTION_VERB, &["f.toml:2, key segment[1].kind", "`sinus`", "remedy:", "`sine`"]),
    ("unknown key",        "[[segment]]\nkind = \"hold\"\nsecond = 1\n",               MOTION_VERB, &["unknown key `second`", "f.toml:3, key segment[1].second", "remedy: write `seconds`"]),
    ("no segment",         "",                                                         MOTION_VERB, &["f.toml", "remedy:", "[[segment]]"]),
    ("HTML",               "<html>\n",                                                 MOTION_VERB, &["this is an HTML or XML page, not TOML", "f.toml:1", "remedy:"]),
    ("unknown key",        "[contact]\ntouch_sigmas = 6\n",                            CONFIG_VERB, &["unknown key `touch_sigmas` in `contact`", "f.toml:2, key contact.touch_sigmas", "remedy: write `touch_sigma`"]),
    ("unknown table",      "[filters]\n",                                              CONFIG_VERB, &["unknown key `filters`", "f.toml:1", "remedy: write `filter`"]),
    ("out of range",       "[filter]\nhalf_width = 1000\n",                            CONFIG_VERB, &["outside its bounds", "f.toml:2, key filter.half_width", "value: `1000`", "remedy: `half_width` is"]),
    ("refused by the core", "[contact]\ntouch_sigma = 2000.0\n",                       CONFIG_VERB, &["`touch_sigma` cannot be 2000", "f.toml:2, key contact.touch_sigma", "value: `2000.0`", "remedy: must lie between"]),
];
const MODEL_VERB: &str = "simulate --model f.toml --out out";
const MOTION_VERB: &str = "simulate --model model.toml --motion f.toml --out out";
const CONFIG_VERB: &str = "estimate log.csv --config f.toml --out out";

#[test]
fn every_wrong_toml_is_refused_on_one_screen_by_the_verb_that_reads_it() {
    for (case, content, verb, words) in WRONG_TOML {
        let folder = Folder::with("f.toml", content);
        folder.write("model.toml", MODEL);
        folder.write("log.csv", csv(press()));
        assert_refused(case, &folder.palpate(verb), words);
        assert!(!folder.path("out").exists(), "{case}: something is written");
    }
}

#[test]
fn what_is_no_file_or_no_text_is_refused_wherever_a_file_is_read() {
    for verb in [
        "estimate FILE --out out",
        "check FILE",
        MODEL_VERB,
        MOTION_VERB,
        CONFIG_VERB,
    ] {
        let verb = verb.replace("f.toml", "FILE");
        let folder = Folder::with("log.csv", csv(press()));
        folder.write("model.toml", MODEL);
        std::fs::create_dir(folder.path("a-folder")).unwrap();
        folder.write("a-binary", [0x00, 0xff, 0xfe, 0x07].repeat(99));
        // A folder may stand for the logs in it.
        let a_folder = match verb.starts_with("estimate FILE") || verb.starts_with("check") {
            true => [
                "no log is in this folder",
                "--> a-folder",
                "remedy: give the log itself",
            ],
            false => ["Is a directory", "--> a-folder", "not the folder"],
        };
        for (file, words) in [
            ("a-folder", a_folder),
            (
                "nowhere.x",
                ["No such file", "--> nowhere.x", "remedy: check the path"],
            ),
            ("a-binary", ["this is", "--> a-binary", "remedy:"]),
        ] {
            let refused = folder.palpate(&verb.replace("FILE", file));
            assert_refused(&format!("{verb} {file}"), &refused, &words);
        }
        assert!(!folder.path("out").exists(), "{verb}: something is written");
    }
}

#[rustfmt::skip]
const WRONG_ARGUMENTS: [(&str, &[&str]); 19] = [
    ("estimate",                                       &["required arguments", "<LOG>"]),
    ("estimate log.csv --law zenner",                  &["'zenner' for '--law", "hunt_crossley"]),
    ("estimate log.csv --method magic",                &["'magic' for '--method", "two_stage"]),
    ("estimate log.csv --law kelvin_voigt --method two_stage", &["value: `two_stage`", "remedy: rls and rls_surface go with"]),
    ("estimate log.csv --every 0",                     &["'0' for '--every", "1.."]),
    ("estimate log.csv --every 1.5",                   &["'1.5' for '--every", "invalid digit"]),
    ("estimate log.csv --reference-depth 0",           &["'0' for '--reference-depth", "must be positive, in metres"]),
    ("estimate log.csv --reference-depth NaN",         &["'NaN' for '--reference-depth", "must be finite"]),
    ("estimate log.csv --reference-depth 1mm",         &["'1mm' for '--reference-depth", "such as 0.001"]),
    ("estimate log.csv --reference-depth 1e6",         &["key reference.depth_m", "value: `1000000`", "remedy: must lie between"]),
    ("estimate log.csv --surface inf",                 &["'inf' for '--surface", "must be finite"]),
    ("estimate log.csv --columns q=x_m",               &["'q=x_m' for '--columns", "not a channel and a column", "remedy: write it like t=Time[ms]*1e-3"]),
    ("check log.csv --columns x=x_m*0",                &["'x=x_m*0' for '--columns", "the factor must be a number other than 0", "remedy:"]),
    ("check log.csv --columns x=depth",                &["no column `depth` for the position", "log.csv:1", "`x_m`"]),
    ("simulate --model model.toml --seed -1 --out out", &["'-1'"]),
    ("gap --model model.toml --log log.csv --noise 0.02", &["'--log <LOG>' cannot be used with '--noise <N>'"]),
    ("gap --model model.toml --log log.csv --motion m.toml", &["'--log <LOG>' cannot be used with '--motion <FILE>'"]),
    ("demo --json",                                    &["no result to write as JSON", "--json", "remedy: leave --json out"]),
    ("--json",                                         &["no result to write as JSON", "--json"]),
];

#[test]
fn every_wrong_argument_is_refused_on_one_screen() {
    for (line, words) in WRONG_ARGUMENTS {
        let folder = Folder::with("log.csv", csv(press()));
        folder.write("model.toml", MODEL);
        assert_refused(line, &folder.palpate(line), words);
        assert!(!folder.path("out").exists(), "{line}: something is written");
    }
}

#[test]
fn three_messages_as_they_stand_on_the_screen() {
    let folder = Folder::with("log.csv", with_line_17("0.015,-0.001000,abc"));
    folder.write(
        "other.csv",
        "Elapsed Time (s),Displacement (mm),Load\n0,0,0\n",
    );
    folder.write("model.toml", MODEL.replace("exponent", "exponnent"));
    let screen = |line: &str| complained(&folder.palpate(line));
    let text = "\
error: text where a number should be
  --> log.csv:17, column f_n
   | 0.015,-0.001000,abc
   |                 ^^^
   = value: `abc`
   = remedy: write the force in newtons, or leave the row out
";
    assert_eq!(screen("estimate log.csv"), text);
    let column = "\
error: no column `f_n` for the force in newtons
  --> other.csv:1, column f_n
   | Elapsed Time (s),Displacement (mm),Load
   = note: the columns are `Elapsed Time (s)`, `Displacement (mm)`, `Load`
   = note: `Load` may hold the force, but its unit is not said
   = note: in --columns, *1e3 if it is in kN, *1e-3 if in mN, nothing if in N
   = remedy: name the columns, perhaps --columns
             't=Elapsed Time (s),x=Displacement (mm)*1e-3,f=Load' if the force is in N; behind
             another unit a factor is needed
";
    assert_eq!(screen("check other.csv"), column);
    let key = "\
error: unknown key `exponnent` in `environment`
  --> model.toml:5, key environment.exponnent
   | exponnent = 1.35
   | ^^^^^^^^^
   = value: `exponnent`
";
    let said = screen("simulate --model model.toml --out out");
    assert!(said.starts_with(key), "{said}");
    assert!(
        said.ends_with("   = remedy: write `exponent`, or remove it\n"),
        "{said}"
    );
}

#[test]
fn a_folder_that_cannot_be_made_is_a_failure_and_no_bad_input() {
    let folder = Folder::with("log.csv", csv(press()));
    folder.write("model.toml", MODEL);
    for line in [
        "estimate log.csv --out log.csv/out",
        "simulate --model model.toml --out log.csv/out",
        "demo --out log.csv/out",
    ] {
        let failed = folder.palpate(line);
        let text = complained(&failed);
        assert_eq!(failed.status.code(), Some(1), "{line}: {text}");
        assert!(
            text.starts_with("error: cannot write log.csv/out/"),
            "{line}: {text}"
        );
        assert_eq!(text.lines().count(), 1, "{line}: {text}");
        assert_eq!(folder.read("log.csv"), csv(press()), "{line}");
    }
}

#[test]
fn a_reader_that_stops_early_is_no_failure_and_the_files_are_written_all_the_same() {
    let folder = Folder::with("log.csv", csv(press()));
    folder.write("model.toml", MODEL);
    for (line, file) in [
        ("check log.csv", "log.csv"),
        ("estimate log.csv --out out", "out/report.html"),
        ("simulate --model model.toml --out run", "run/log.csv"),
    ] {
        let arguments: Vec<&str> = line.split(' ').collect();
        let mut command = folder.command(&arguments);
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().unwrap();
        drop(child.stdout.take());
        let done = child.wait_with_output().unwrap();
        assert_eq!(complained(&done), "", "{line}");
        assert_eq!(done.status.code(), Some(0), "{line}");
        assert!(folder.path(file).exists(), "{line}: {file}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_a_failure_and_no_panic() {
    let folder = Folder::with("log.csv", csv(press()));
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let done = folder
        .command(&["check", "log.csv"])
        .stdout(full)
        .output()
        .unwrap();
    assert_eq!(done.status.code(), Some(1));
    assert!(complained(&done).starts_with("error: cannot write to standard output"));
}
