//! Measured records with a plain base model each: what their owner would have written down.

use palpate::log::{ColumnMap, Log, ReadOptions};
use palpate::model::Model;
use palpate::toml_reader::TomlFile;
use std::path::{Path, PathBuf};

/// A record and how `palpate gap` is to be asked about it.
#[derive(Clone, Copy, Debug)]
pub struct Record {
    /// The folder.
    pub(crate) folder: &'static str,
    /// The log in it, gzipped or not.
    pub(crate) file: &'static str,
    /// Which columns hold position and force, where they are not the log format's.
    columns: &'static str,
    /// The low-pass of both forces (Hz).
    pub(crate) bandwidth_hz: Option<f64>,
    /// The base model; where it is empty, `base.toml` in the folder.
    base: &'static str,
}

const DRIVE: Record = Record {
    folder: "emps",
    file: "data.csv",
    columns: "",
    bandwidth_hz: Some(20.0),
    base: "",
};

const FOAM: Record = Record {
    folder: "nist_foam_relaxation",
    file: "data_0da.csv",
    bandwidth_hz: None,
    ..DRIVE
};

const SERVO: Record = Record {
    folder: "bam_xl330_pendulum",
    file: "kp400_sin_sin.csv",
    columns: "x=x_rad,f=f_nm_net_of_gravity",
    ..FOAM
};

const DAMPER: Record = Record {
    folder: "friction_damper_backlash",
    file: "data_1hz_30lb_1in.csv",
    base: "[environment]\nlaw = \"free\"\n\
        [[effect]]\nid = \"cable_stiffness\"\nstiffness = 3e5\n\
        [[effect]]\nid = \"viscous_drag\"\ncoefficient = 1e4\n",
    ..FOAM
};

const MEAT: Record = Record {
    folder: "meat_indentation_zwick",
    file: "data_230403_FF1A.csv",
    base: "[environment]\nlaw = \"hunt_crossley\"\nstiffness = 100.0\ndamping = 50.0\n\
        exponent = 1.5\nsurface = 0.002\n",
    ..FOAM
};

/// All records; those that may not enter the repository are looked for in further folders.
pub const ALL: [Record; 20] = [
    DRIVE,
    Record {
        file: "data_pulses.csv",
        ..DRIVE
    },
    FOAM,
    Record {
        file: "data_3da.csv",
        ..FOAM
    },
    Record {
        folder: "afm_relaxation_rheos",
        file: "data.csv",
        ..FOAM
    },
    Record {
        folder: "ankle_foot_desr",
        file: "data_cam1_x33.csv",
        columns: "x=x_rad,f=f_nm",
        ..FOAM
    },
    SERVO,
    Record {
        file: "kp400_up_and_down.csv",
        ..SERVO
    },
    Record {
        file: "kp400_sin_time_square.csv",
        ..SERVO
    },
    Record {
        file: "kp400_lift_and_drop.csv",
        ..SERVO
    },
    Record {
        folder: "afm_cell_relaxation",
        file: "data_cell1-0001.csv",
        ..FOAM
    },
    Record {
        folder: "afm_cell_relaxation",
        file: "data_cell1-0008.csv",
        ..FOAM
    },
    Record {
        folder: "afm_cell_relaxation",
        file: "data_cell1-0015.csv",
        ..FOAM
    },
    DAMPER,
    Record {
        file: "data_1hz_30lb_0.5in.csv",
        ..DAMPER
    },
    Record {
        file: "data_0.25hz_30lb_1in.csv",
        ..DAMPER
    },
    Record {
        folder: "davinci_tool_transmission",
        file: "data_T4L2_00.csv",
        columns: "x=x_rad,f=-f_nm",
        base: "[environment]\nlaw = \"free\"\n\
            [[effect]]\nid = \"tool_inertia\"\nmass = 1e-4\n\
            [[effect]]\nid = \"viscous_drag\"\ncoefficient = 1e-3\n\
            [[effect]]\nid = \"cable_stiffness\"\nstiffness = 0.01\n",
        ..FOAM
    },
    MEAT,
    Record {
        file: "data_230331_FF2-2F.csv",
        ..MEAT
    },
    Record {
        file: "data_230327_RDG1-4.csv",
        ..MEAT
    },
];

impl Record {
    /// The record's name in tables.
    pub fn name(&self) -> String {
        let file = self
            .file
            .trim_end_matches(".csv")
            .trim_start_matches("data_");
        let folder = self.folder.split('_').next().unwrap_or_default();
        format!("{folder}/{file}")
    }

    /// Where the log is, below the first of the folders that hold it.
    pub(crate) fn found(&self, roots: &[PathBuf]) -> Option<PathBuf> {
        let gzipped = format!("{}.gz", self.file);
        self.among(roots, &[self.file, &gzipped])
    }

    /// The first of some names in the record's folder, below the first of the folders that hold one.
    fn among(&self, roots: &[PathBuf], names: &[&str]) -> Option<PathBuf> {
        let folders = roots.iter().map(|root| root.join(self.folder));
        let mut paths = folders.flat_map(|folder| names.iter().map(move |name| folder.join(name)));
        paths.find(|path| path.is_file())
    }

    /// Reads the log and the base model, which may be below different folders.
    pub(crate) fn read(&self, roots: &[PathBuf]) -> Result<(Log, Model), String> {
        let path = self.found(roots).ok_or("the log is not there")?;
        let mut options = ReadOptions::default();
        if !self.columns.is_empty() {
            options.columns = self
                .columns
                .parse::<ColumnMap>()
                .map_err(|e| e.to_string())?;
        }
        let log = Log::read(&path, &options).map_err(|e| e.to_string())?;
        let model = match self.base {
            "" => Model::read(&self.among(roots, &["base.toml"]).ok_or("no base.toml")?),
            text => parsed(text),
        };
        Ok((log, model.map_err(|e| e.to_string())?))
    }
}

/// A model of its text.
pub(crate) fn parsed(text: &str) -> Result<Model, palpate::diagnostic::Diagnostic> {
    let path = Path::new("model.toml");
    Model::from_toml(&TomlFile::parse(text.to_string(), path)?, path)
}
