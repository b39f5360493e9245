//! One versioned binary frame for telemetry, recording and replay.
//! (written below)
