//! What the sampling task costs, as the firmware logs it.

/// The counters of a firmware's sampling task, from the line that it logs.
#[derive(Debug)]
pub struct Budget {
    /// How many samples went through `step`.
    pub samples: u64,
    /// How many times the task ran.
    pub ticks: u64,
    /// How many records found the queue full.
    pub dropped: u64,
    /// How many times the task took longer than a tick.
    pub overruns: u64,
    /// How many instants have no sample.
    pub missed: u64,
    /// Bytes of stack that were never used.
    pub stack_free: u64,
    /// The length of a tick; this and all costs are in instructions in QEMU and in cycles on the board.
    pub tick: u64,
    /// The time between two starts of the task.
    pub period: Meter,
    /// The cost of the conversion from codes to SI units.
    pub convert: Meter,
    /// The cost of rendering a force.
    pub render: Meter,
    /// The cost of taking the rig's effects off.
    pub compensate: Meter,
    /// The cost of `step`.
    pub step: Meter,
    /// The cost of the way from the estimate to the queue.
    pub queue: Meter,
    /// The cost of the whole task.
    pub task: Meter,
    /// The time from the instant at which a sample was due to the end of its task.
    pub response: Meter,
    /// The cost of encoding a record, which is done at low priority.
    pub encode: Meter,
}

/// Smallest, mean and largest value of a series.
#[derive(Debug)]
pub struct Meter {
    /// The smallest.
    pub min: u64,
    /// The mean, rounded down.
    pub mean: u64,
    /// The largest.
    pub max: u64,
}

impl Budget {
    /// Reads the last line of a log that holds the counters.
    pub fn from_log(log: &[String]) -> Result<Self, String> {
        let line = log.iter().rfind(|line| line.contains("budget: "));
        let line = line.ok_or("the firmware logged no budget")?;
        Ok(Budget {
            samples: number(field(line, "samples")?)?,
            ticks: number(field(line, "ticks")?)?,
            dropped: number(field(line, "dropped")?)?,
            overruns: number(field(line, "overruns")?)?,
            missed: number(field(line, "missed")?)?,
            stack_free: number(field(line, "stack_free")?)?,
            tick: number(field(line, "tick")?)?,
            period: meter(field(line, "period")?)?,
            convert: meter(field(line, "convert")?)?,
            render: meter(field(line, "render")?)?,
            compensate: meter(field(line, "compensate")?)?,
            step: meter(field(line, "step")?)?,
            queue: meter(field(line, "queue")?)?,
            task: meter(field(line, "task")?)?,
            response: meter(field(line, "response")?)?,
            encode: meter(field(line, "encode")?)?,
        })
    }
}

fn field<'a>(line: &'a str, key: &str) -> Result<&'a str, String> {
    line.split_whitespace()
        .find_map(|word| word.strip_prefix(key)?.strip_prefix('='))
        .ok_or_else(|| format!("no {key} in `{line}`"))
}

fn number(text: &str) -> Result<u64, String> {
    text.parse().map_err(|e| format!("`{text}`: {e}"))
}

fn meter(text: &str) -> Result<Meter, String> {
    let numbers: Vec<u64> = text.split('/').map(number).collect::<Result<_, _>>()?;
    match numbers[..] {
        [min, mean, max] => Ok(Meter { min, mean, max }),
        _ => Err(format!("`{text}` is not min/mean/max")),
    }
}
