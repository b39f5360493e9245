use super::*;

fn empty() -> EstimateReport<'static> {
    EstimateReport {
        title: "empty",
        tone: Tone::Neutral,
        badge: "no contact",
        verdict: "Nothing was touched.",
        runs: &[],
        notes: &[],
        provenance: Provenance::new("palpate estimate empty.csv"),
    }
}
