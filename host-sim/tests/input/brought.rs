//! What people bring: one palpation of a gel of K 1350, written in the ways of other machines. Without a flag
//! where names or units say it, with the flag of the question where not, K comes out within 1 %.

use crate::common::{Folder, MODEL, complained, csv, flowing, press, said};
use std::process::{Output, Stdio};
use std::sync::OnceLock;

/// Stiffness of the gel (N/m), and how near the estimate has to be.
const STIFFNESS: f64 = 1350.0;
const NEAR: f64 = 0.01;

/// Rows of time (s), position (m), force (N) of a simulated palpation of the gel; seed 1.
fn gel() -> &'static [[f64; 3]] {
    static GEL: OnceLock<Vec<[f64; 3]>> = OnceLock::new();
    GEL.get_or_init(|| {
        let folder = Folder::with("gel.toml", MODEL);
        folder.succeeds("simulate --model gel.toml --out run");
        let text = folder.read("run/log.csv");
        let row = |line: &str| {
            let mut cells = line.split(',').map(|cell| cell.parse::<f64>().unwrap());
            std::array::from_fn(|_| cells.next().unwrap())
        };
        text.lines().skip(1).map(row).collect()
    })
}

/// Every row of the gel in a machine's writing, below its header.
fn written(header: &str, row: impl Fn(usize, [f64; 3]) -> String) -> String {
    let mut text = String::from(header);
    for (number, cells) in gel().iter().enumerate() {
        text.push_str(&row(number, *cells));
        text.push('\n');
    }
    text
}

fn comma(text: String) -> String {
    text.replace('.', ",")
}

/// A number with points between thousands and a decimal comma.
fn grouped(value: f64) -> String {
    let text = format!("{:.2}", value.abs());
    let (whole, part) = text.split_once('.').unwrap();
    let mut digits = String::new();
    for (at, digit) in whole.chars().enumerate() {
        if at > 0 && (whole.len() - at).is_multiple_of(3) {
            digits.push('.');
        }
        digits.push(digit);
    }
    format!("{}{digits},{part}", if value < 0.0 { "-" } else { "" })
}

/// The time of day of a sample, as a date and a time with milliseconds.
fn clock(t: f64) -> String {
    let t = 43_195.0 + t;
    let (hours, minutes) = ((t / 3600.0).floor(), (t / 60.0).floor() % 60.0);
    format!("{hours:02.0}:{minutes:02.0}:{:06.3}", t % 60.0)
}

fn latin_1(text: &str) -> Vec<u8> {
    text.chars()
        .map(|c| u8::try_from(u32::from(c)).unwrap())
        .collect()
}

fn utf_16(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

/// Minutes and seconds (s) of an hour in which a recording begins after 59.9 s.
fn minutes(t: f64) -> String {
    let t = 59.9 + t;
    format!("{:02.0}:{:06.3}", (t / 60.0).floor(), t % 60.0)
}

/// What an AFM's software writes: approach, pause and retraction, each below its own header.
fn segments_of_an_afm() -> String {
    let mut text = String::from("# springConstant: 0.04\n");
    for (number, part) in gel().chunks(3000).enumerate() {
        text += &format!(
            "\n# segmentIndex: {number}\n#\n# columns: vDeflection measuredHeight seriesTime\n\
             # fancyNames: \"Vertical deflection\" \"Height (measured)\" \"Series Time\"\n# units: N m s\n"
        );
        for [t, x, f] in part {
            text += &format!("{f:.5e} {:.6e} {t:.6e}\n", 0.01 - x);
        }
    }
    text
}

/// A machine's file: what it is, its content, the flags, and what the sentence about it says.
type Brought = (&'static str, Vec<u8>, &'static [&'static str], &'static str);

#[rustfmt::skip]
fn machines() -> Vec<Brought> {
    vec![
        ("Instron Bluehill", written(
            "\"Results Table 1\"\n\"\",\"Maximum Load (N)\",\"Extension (mm)\"\n\"1\",\"12.5\",\"4.3\"\n\"2\",\"12.6\",\"4.3\"\n\"3\",\"12.6\",\"4.3\"\n\n\
             \"Raw Data\"\n\"Time\",\"Extension\",\"Load\"\n\"(s)\",\"(mm)\",\"(N)\"\n",
            |_, [t, x, f]| format!("\"{t:.3}\",\"{:.4}\",\"{f:.4}\"", x * 1e3)).into(), &[], "position from `Extension` in mm"),
        ("Instron WaveMatrix", written(
            "Total Time (s),Total Cycles,Position(Linear:Position) (mm),Load(Linear:Load) (kN)\n",
            |_, [t, x, f]| format!("{t:.3},0,{:.4},{:.6}", x * 1e3, f * 1e-3)).into(), &[], "force from `Load(Linear:Load) (kN)` in kN"),
        ("Zwick testXpert", latin_1(&written(
            "\"Prüfprotokoll\"\n\"Kunde\";\"Universität\"\n\"Breite\";12,5;\"mm\"\n\nPrüfzeit;Standardweg;Standardkraft\ns;mm;N\n",
            |_, [t, x, f]| comma(format!("{t:.3};{:.4};{f:.4}", x * 1e3)))), &[], "text in Latin-1"),
        ("Zwick, tabs, units in brackets", latin_1(&written(
            "Prüfzeit [s]\tStandardweg [mm]\tTraversenweg [mm]\tStandardkraft [kN]\n",
            |_, [t, x, f]| comma(format!("{t:.3}\t{:.4}\t{:.4}\t{:.6}", x * 1e3, x * 1.1e3, f * 1e-3)))), &[], "position from `Standardweg [mm]` in mm"),
        ("Bruker JPK", written(
            "# xPosition: 0.0\n# springConstant: 0.04\n#\n# columns: vDeflection measuredHeight seriesTime\n# fancyNames: \"Vertical deflection\" \"Height (measured)\" \"Series Time\"\n# units: N m s\n",
            |_, [t, x, f]| format!("{f:.5e} {:.6e} {t:.6e}", 0.01 - x)).into(), &[], "the sign of the position reversed"),
        ("Bruker Hysitron", latin_1(&written(
            "TriboScan\r\n\r\nNumber of Points = 8566\r\n\r\nDepth (nm)\tLoad (µN)\tTime (s)\tDepth (V)\tLoad (V)\r\n",
            |_, [t, x, f]| format!("{:.1}\t{:.1}\t{t:.3}\t{:.6}\t{:.6}\r", x * 1e9, f * 1e6, x * 10.0, f * 0.1))), &[], "force from `Load (µN)` in µN"),
        ("Bruker NanoScope", written("Calc_Ramp_Ex_nm\tDefl_nN\tTime_s\n",
            |_, [t, x, f]| format!("{:.1}\t{:.1}\t{t:.4}", x * 1e9, f * 1e9)).into(), &[], "position from `Calc_Ramp_Ex_nm` in nm"),
        ("Bruker JPK, each segment with its header", segments_of_an_afm().into(), &[], "the sign of the position reversed"),
        ("Zwick with results and statistics above", written(
            "Ergebnisse:\nNr;Fmax;dL bei Fmax\n;N;mm\n1;12,6;4,3\n\nStatistik:\nx;12,6;4,3\n\nProbe 1\nPrüfzeit;Standardweg;Standardkraft\ns;mm;N\n",
            |_, [t, x, f]| comma(format!("{t:.3};{:.4};{f:.4}", x * 1e3))).into(), &[], "force from `Standardkraft` in N"),
        ("Anton Paar, a row of blanks above the units", utf_16(&written(
            "Name:\tgel\nInterval data:\tPoint No.\tTime\tGap\tNormal Force\n\t\t\t\t\n\t\t[s]\t[mm]\t[N]\n",
            |n, [t, x, f]| format!("\t{n}\t{t:.3}\t{:.4}\t{f:.4}", 20.0 - x * 1e3))), &[], "units in line 4"),
        ("titles in angle brackets", (written("<INFO>\nDate:\t2026-03-01\n<END INFO>\n<DATA>\nTime, s\tPosition (z), mm\tFz, gf\n",
            |_, [t, x, f]| format!("{t:.3}\t{:.4}\t{:.3}", x * 1e3, f / 9.80665e-3)) + "<END DATA>\n").into(), &[], "1 row below the table left out"),
        ("a texture analyser in grams", written("Force,Distance,Time\ng,mm,sec\n",
            |_, [t, x, f]| format!("{:.3},{:.4},{t:.3}", f / 9.80665e-3, x * 1e3)).into(), &[], "position from `Distance` in mm"),
        ("LabVIEW with a comment that is never made", written("LabVIEW Measurement\t\n***End_of_Header***\t\n\nX_Value\tPosition (mm)\tForce (N)\tComment\n",
            |_, [t, x, f]| format!("{t:.3}\t{:.4}\t{f:.4}", x * 1e3)).into(), &["--columns", "t=X_Value"], "time from `X_Value`"),
        ("UTF-16 of a spreadsheet", utf_16(&written("Zeit [s];Weg [µm];Kraft [mN]\r\n",
            |_, [t, x, f]| comma(format!("{t:.3};{:.1};{:.1}\r", x * 1e6, f * 1e3)))), &[], "text in UTF-16"),
        ("French", written("Temps (s);Déplacement (mm);Effort (N)\n",
            |_, [t, x, f]| comma(format!("{t:.3};{:.4};{f:.4}", x * 1e3))).into(), &[], "force from `Effort (N)` in N"),
        ("Spanish", written("Tiempo (s)\tDesplazamiento (mm)\tFuerza (N)\n",
            |_, [t, x, f]| format!("{t:.3}\t{:.4}\t{f:.4}", x * 1e3)).into(), &[], "position from `Desplazamiento (mm)` in mm"),
        ("MTS with units in words", written("MTS793|MPT|ENU\n\nTime\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n",
            |_, [t, x, f]| format!("{t:.3}\t{:.4}\t{:.7}", x * 1e3, f * 1e-3)).into(), &[], "units in line 4"),
        ("names that say nothing", written("Kanal 1 [ms];Kanal 2 [N];Kanal 3 [mm]\n",
            |_, [t, x, f]| comma(format!("{:.1};{f:.4};{:.4}", t * 1e3, x * 1e3))).into(), &[], "force from `Kanal 2 [N]` in N"),
        ("comments of Matlab", written("% rig 3\n% t [ms]  x [mm]  Fz [N]\n",
            |_, [t, x, f]| format!("  {:.1}   {:.4}\t{f:.4}  ", t * 1e3, x * 1e3)).into(), &[], "time from `t [ms]` in ms"),
        ("comments of numpy", written("# Time (s),Position (mm),Force (N)\n",
            |_, [t, x, f]| format!("{t:.5e},{:.5e},{f:.5e}", x * 1e3)).into(), &[], "force from `Force (N)` in N"),
        ("thousands with points", written("Zeit [ms];Weg [µm];Kraft [mN]\n",
            |_, [t, x, f]| format!("{};{};{}", grouped(t * 1e3), grouped(x * 1e6), grouped(f * 1e3))).into(), &[], "separated thousands"),
        ("thousands in quotes", written("Time (ms),Position (um),Force (mN)\n",
            |_, [t, x, f]| {
                let english = |value| grouped(value).replace('.', "\u{1}").replace(',', ".").replace('\u{1}', ",");
                format!("\"{}\",\"{}\",\"{}\"", english(t * 1e3), english(x * 1e6), english(f * 1e3))
            }).into(), &[], "separated thousands"),
        ("thousands of whole numbers", written("sep=;\nZeit [s];Weg [nm];Kraft [µN]\n",
            |_, [t, x, f]| {
                let whole = |value: f64| grouped(value.round()).replace(",00", "");
                format!("{};{};{}", comma(format!("{t:.3}")), whole(x * 1e9), whole(f * 1e6))
            }).into(), &[], "separated thousands"),
        ("titles above columns without names", written("Instrument\tDMA\nSize\t12.0 mm\nSig1\tTime (min)\nStartOfData\n",
            |_, [t, x, f]| format!("{:.7}\t{:.2}\t{f:.4}", t / 60.0, x * 1e6)).into(), &["--columns", "t=1*60,x=2*1e-6,f=3"], "time from `1` × 60"),
        ("an empty row below the units", written("Time;Position;Force\n[s];[mm];[N]\n;;\n",
            |_, [t, x, f]| format!("{t:.3};{:.4};{f:.4}", x * 1e3)).into(), &[], "units in line 2"),
        ("thousands with thin blanks", written("Temps (ms);Déplacement (µm);Force (mN)\n",
            |_, [t, x, f]| {
                let french = |value| grouped(value).replace('.', "\u{202f}");
                format!("{};{};{}", french(t * 1e3), french(x * 1e6), french(f * 1e3))
            }).into(), &[], "force from `Force (mN)` in mN"),
        ("minus signs of typesetting", written("Time (s);Travel (mm);Load (N)\n",
            |_, [t, x, f]| format!("{t:.3};{:.4};{f:.4}", x * 1e3).replace('-', "−")).into(), &[], "position from `Travel (mm)` in mm"),
        ("stamps of a second", written("Date and time;Travel (mm);Load (N)\n",
            |_, [t, x, f]| format!("01.03.2026 {};{:.4};{f:.4}", &clock(t)[..8], x * 1e3)).into(), &[], "taken as even, 1000 a second"),
        ("times of day in the afternoon", written("Date/Time,Position (mm),Force (N)\n",
            |_, [t, x, f]| format!("03/01/2026 01:{} PM,{:.4},{f:.4}", minutes(t), x * 1e3)).into(), &[], "time from `Date/Time` in s"),
        ("recordings side by side, by their numbers", written("Specimen 1,,,Specimen 2,,\nTime,Extension,Load,Time,Extension,Load\n(s),(mm),(N),(s),(mm),(N)\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{f:.4},{t:.3},{:.4},{f:.4}", x * 2e3, x * 1e3)).into(), &["--columns", "t=4,x=5,f=6"], "position from `Extension` in mm"),
        ("dates of ISO 8601", written("time,position_mm,force_N\n",
            |_, [t, x, f]| format!("2026-03-01T{}Z,{:.4},{f:.4}", clock(t), x * 1e3)).into(), &[], "time from `time` in s"),
        ("German dates", written("Zeitstempel;Weg / mm;Kraft / N\n",
            |_, [t, x, f]| format!("01.03.2026 {};{}", comma(clock(t)), comma(format!("{:.4};{f:.4}", x * 1e3)))).into(), &[], "force from `Kraft / N` in N"),
        ("date and time apart", written("Date,Time,Depth (mm),Force (N)\n",
            |_, [t, x, f]| format!("2026-03-01,{},{:.4},{f:.4}", clock(t), x * 1e3)).into(), &[], "time from `Time` in s"),
        ("milliseconds since 1970", written("timestamp,pos_mm,Fz_N\n",
            |_, [t, x, f]| format!("{:.0},{:.4},{f:.4}", 1_772_366_400_000.0 + t * 1e3, x * 1e3)).into(), &[], "time from `timestamp` in ms"),
        ("nanoseconds since 1970", written("stamp;z_um;force_mN\n",
            |_, [t, x, f]| format!("{};{:.2};{:.2}", 1_772_366_400_000_000_000u64 + (t * 1e9) as u64, x * 1e6, f * 1e3)).into(), &[], "time from `stamp` in ns"),
        ("lines of a Macintosh", written("Time (s),Extension (mm),Load (N)\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{f:.4}", x * 1e3)).replace('\n', "\r").into(), &[], "position from `Extension (mm)` in mm"),
        ("a summary below", (written("Time (s);Extension (mm);Load (N)\n",
            |_, [t, x, f]| format!("{t:.3};{:.4};{f:.4}", x * 1e3)) + "\nMaximum;4.36;12.6\nMean;1.0;3.0\n\nTested by: A. Person\n").into(), &[], "rows below the table left out from line 8569 on (`Maximum;4.36;12.6`): a summary"),
        ("stamps of 10 ms", written("Time (s),Extension (mm),Load (N)\n",
            |_, [t, x, f]| format!("{:.2},{:.4},{f:.4}", (t * 100.0 + 1e-6).floor() / 100.0, x * 1e3)).into(), &[], "taken as even, 1000"),
        ("compression is negative", written("Time (s),Extension (mm),Load (N)\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{:.4}", -x * 1e3, -f)).into(), &[], "both signs reversed"),
        ("the gap above the sample", written("Time (s),Gap (mm),Normal force (N)\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{f:.4}", 20.0 - x * 1e3)).into(), &[], "the sign of the position reversed"),
        ("the force counts pulls", written("Time (s),Extension (mm),Load (N)\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{:.4}", x * 1e3, -f)).into(), &[], "the sign of the force reversed"),
        ("kilograms and inches", written("Elapsed Time (min),Crosshead (in),Load (kgf)\n",
            |_, [t, x, f]| format!("{:.8},{:.7},{:.6}", t / 60.0, x / 0.0254, f / 9.80665)).into(), &[], "force from `Load (kgf)` in kgf"),
        ("setpoints and derived columns beside", written("Time (s),Force setpoint (N),Speed (mm/s),Stress (MPa),Position (mm),Force (N),phase\n",
            |_, [t, x, f]| format!("{t:.3},0,0,0,{:.4},{f:.4},go", x * 1e3)).into(), &[], "force from `Force (N)` in N"),
        ("segments with a time of their own", written("Segment;Segment time (s);Depth (mm);Force (N)\n",
            |n, [t, x, f]| format!("{};{:.3};{:.4};{f:.4}", 1 + n / 3000, t - (n / 3000) as f64 * 3.0, x * 1e3)).into(), &[], "3 segments put one after the other"),
        ("no time at all", written("Position (mm),Force (N)\n",
            |_, [_, x, f]| format!("{:.4},{f:.4}", x * 1e3)).into(), &["--rate", "1000"], "sampled evenly at 1000 Hz"),
        ("no header", written("", |_, [t, x, f]| format!("{:.1},{:.4},{f:.4}", t * 1e3, x * 1e3)).into(), &["--columns", "t=1*1e-3,x=2*1e-3,f=3"], "position from `2` × 0.001"),
        ("no units", written("Time,Position,Force\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{f:.4}", x * 1e3)).into(), &["--columns", "t=Time,x=Position*1e-3,f=Force"], "position from `Position` × 0.001"),
        ("two columns that fit", written("Time (s),Extension (mm),Position (mm),Load (N)\n",
            |_, [t, x, f]| format!("{t:.3},{:.4},{:.4},{f:.4}", x * 1e3, x * 1.2e3)).into(), &["--columns", "x=Extension (mm)"], "position from `Extension (mm)` in mm"),
    ]
}

/// K (N/m) of an estimate that was written into `out`.
fn stiffness(folder: &Folder, file: &str) -> f64 {
    let json: serde_json::Value = serde_json::from_str(&folder.read(file)).unwrap();
    json["parameters"]["stiffness"]["value"]
        .as_f64()
        .unwrap_or(f64::NAN)
}

fn with_file<'a>(verb: &'a str, file: &'a str, flags: &'a [&'a str]) -> Vec<&'a str> {
    [&[verb, file], flags].concat()
}

fn assert_gel(case: &str, value: f64) {
    assert!((value / STIFFNESS - 1.0).abs() < NEAR, "{case}: K {value}");
}

#[test]
fn every_machine_is_understood_and_says_how() {
    for (case, content, flags, words) in machines() {
        let folder = Folder::with("log.txt", content);
        let arguments = [
            with_file("estimate", "log.txt", flags),
            vec!["--out", "out"],
        ]
        .concat();
        let done = folder.command(&arguments).output().unwrap();
        assert_eq!(done.status.code(), Some(0), "{case}: {}", complained(&done));
        let text = flowing(&said(&done));
        assert!(text.contains(words), "{case}: no `{words}` in {text}");
        assert_gel(case, stiffness(&folder, "out/estimate.json"));
        let check = folder
            .command(&with_file("check", "log.txt", flags))
            .output()
            .unwrap();
        let text = flowing(&said(&check));
        assert!(
            text.contains(words),
            "{case}: no `{words}` in {text}{}",
            complained(&check)
        );
    }
}

/// Files that leave something open: what they are, their content, and the words of the question.
#[rustfmt::skip]
fn open_questions() -> Vec<(&'static str, String, &'static [&'static str])> {
    let rows = |header: &str, row: fn([f64; 3]) -> String| {
        let rows = press().into_iter().map(row);
        rows.fold(format!("{header}\n"), |text, row| text + &row + "\n")
    };
    let restart = csv(press()) + csv(press()).split_once('\n').unwrap().1;
    vec![
        ("no unit",        rows("Time (s),Extension (mm),Load", |[t, x, f]| format!("{t},{},{f}", x * 1e3)), &["no column `f_n`", "its unit is not said", "*1e3 if it is in kN", "--columns 't=Time (s),x=Extension (mm)*1e-3,f=Load'"]),
        ("capitals",       rows("T (S),X (MM),F (MN)", |[t, x, f]| format!("{t},{},{}", x * 1e3, f * 1e3)), &["no column `f_n`", "`F (MN)` may hold the force, but its unit is not said", "*1e-3 if in mN"]),
        ("no unit of time", rows("Time,Extension (mm),Load (N)", |[t, x, f]| format!("{t},{},{f}", x * 1e3)), &["`Time` may hold the time, but its unit is not said", "*1e-3 if it is in ms"]),
        ("two positions",  rows("Time (s),Extension (mm),Position (mm),Load (N)", |[t, x, f]| format!("{t},{},{},{f}", x * 1e3, x * 2e3)), &["more than one column may hold the position", "--columns 'x=Extension (mm)' or --columns 'x=Position (mm)'"]),
        ("no time",        rows("Extension (mm),Load (N)", |[_, x, f]| format!("{},{f}", x * 1e3)), &["no column `t_s`", "--rate HZ"]),
        ("time restarts",  restart, &["time runs backward", "log.csv:2002", "--trace-column 't_s'", "--segment-column 't_s'"]),
        ("which sign",     rows("Time (s),Extension (mm),Load (N)", |[t, x, _]| format!("{t},{},{}", x * 1e3, -x * 1e3)), &["the force falls on the way in", "--columns 'x=-Extension (mm)' or --columns 'f=-Load (N)'"]),
        ("half a rotary rig", rows("Time (s),Angle (deg),Force (N)", |[t, x, f]| format!("{t},{},{f}", x * 1e3)), &["a position in ° and a force in N do not belong to one machine", "log.csv:1"]),
        ("a column that is not there", rows("Time (s),Temperature (°C),Load (N)", |[t, x, f]| format!("{t},{},{f}", x * 1e3)), &["no column `x_m` for the position", "`Temperature (°C)`", "name the columns"]),
        ("no time but numbers of samples", rows("Sample,Travel (mm),Load (N)", |[t, x, f]| format!("{},{},{f}", (t * 1e3).round(), x * 1e3)), &["no column `t_s`", "--rate HZ"]),
        ("recordings side by side", rows("Time (s),Travel (mm),Load (N),Time (s),Travel (mm),Load (N)", |[t, x, f]| format!("{t},{0},{f},{t},{0},{f}", x * 1e3)), &["more than one column may hold the time", "recordings side by side?", "--columns 't=1,x=2*1e-3,f=3'"]),
        ("volts",          rows("Time (s),Position (V),Force (V)", |[t, x, f]| format!("{t},{x},{f}")), &["`Position (V)` is not in a unit of position", "--columns 'x=Position (V)*FACTOR'"]),
        ("strain and stress", rows("Time (s),Strain (%),Stress (MPa)", |[t, x, f]| format!("{t},{x},{f}")), &["`Strain (%)` is not in a unit of position", "the height of the sample in m, divided by 100"]),
        ("units in the cells", rows("Time;Travel;Load", |[t, x, f]| format!("{t} s;{x} m;{f} N")), &["`Time` holds text, such as `0 s`", "the unit must stand in the header"]),
        ("the header again and time from 0", csv(press()) + &csv(press()), &["time runs backward", "--trace-column 't_s'"]),
        ("numbers only",   rows("0,0,0", |[t, x, f]| format!("{t},{x},{f}")), &["not the names of the columns", "log.csv:1", "--columns 't=1,x=2*1e-3,f=3'"]),
    ]
}

#[test]
fn where_a_guess_could_be_wrong_it_is_a_question_with_the_flag_that_answers_it() {
    for (case, content, words) in open_questions() {
        let folder = Folder::with("log.csv", content);
        for verb in ["check", "estimate"] {
            let done = folder.palpate(&format!("{verb} log.csv"));
            let text = flowing(&complained(&done));
            assert_eq!(done.status.code(), Some(2), "{case}: {text}");
            for word in words {
                assert!(text.contains(word), "{case}: no `{word}` in {text}");
            }
            assert!(text.contains("remedy:"), "{case}: {text}");
        }
    }
}

#[test]
fn recordings_in_one_file_are_estimated_one_by_one() {
    let twice = written("Curve,Time (s),Depth (mm),Force (N)\n", |_, [t, x, f]| {
        format!("A,{t:.3},{:.4},{f:.4}", x * 1e3)
    }) + &written("", |_, [t, x, f]| format!("B,{t:.3},{:.4},{f:.4}", x * 1e3));
    let folder = Folder::with("log.csv", twice);
    // The name of the column says what begins where time does.
    folder.succeeds("estimate log.csv --out out");
    for name in ["log-A", "log-B"] {
        assert_gel(
            name,
            stiffness(&folder, &format!("out/{name}/estimate.json")),
        );
    }
    folder.succeeds("estimate log.csv --trace-column Curve --out asked");
    assert_gel("asked", stiffness(&folder, "asked/log-B/estimate.json"));
}

#[test]
fn time_that_begins_again_is_answered_by_a_flag() {
    let restart =
        csv(gel().iter().copied()) + csv(gel().iter().copied()).split_once('\n').unwrap().1;
    let folder = Folder::with("log.csv", restart);
    folder.succeeds("estimate log.csv --trace-column t_s --out traces");
    assert_gel(
        "second trace",
        stiffness(&folder, "traces/log-2/estimate.json"),
    );
    folder.succeeds("estimate log.csv --segment-column t_s --out whole");
    assert_gel(
        "one after the other",
        stiffness(&folder, "whole/estimate.json"),
    );
}

#[test]
fn standard_input_is_a_log_and_its_mistakes_have_their_lines() {
    let folder = Folder::new();
    let fed_to = |arguments: &[&str], text: &str| -> Output {
        let mut command = folder.command(arguments);
        let piped = command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = piped.spawn().unwrap();
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), text.as_bytes()).unwrap();
        child.wait_with_output().unwrap()
    };
    let fed = |text: &str| fed_to(&["check", "-"], text);
    let good = fed(&csv(press()));
    assert_eq!(good.status.code(), Some(0), "{}", complained(&good));
    assert!(said(&good).contains("2000 samples"), "{}", said(&good));
    let bad = fed(&csv(press()).replacen("\n0.005,", "\nnan,", 1));
    assert_eq!(bad.status.code(), Some(2));
    assert!(
        complained(&bad).contains("standard input:7, column t_s"),
        "{}",
        complained(&bad)
    );
    // AND a report says which bytes it was made from.
    let done = fed_to(
        &["estimate", "-", "--out", "out"],
        &csv(gel().iter().copied()),
    );
    assert_eq!(done.status.code(), Some(0), "{}", complained(&done));
    assert!(folder.read("out/report.html").contains("sha256:"));
}
