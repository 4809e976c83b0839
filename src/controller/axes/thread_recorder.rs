//! Measures each thread while it is cut: lead error from the Z and the spindle encoder of the same tick.
//! Source: spec L5.

use crate::link::thread_cut::ThreadCut;

/// Maximum number of recorded threads.
const MAX_THREADS: usize = 256;
/// Approach travel before the lead is measured, in leads, as the manual requires.
const APPROACH_LEADS: f64 = 3.0;

/// Measured deviation of Z from its nominal position in a thread, mm.
#[derive(Clone, Copy, Debug)]
struct ThreadMeasurement {
    line: u32,
    lead_mm: f64,
    start_mm: f64,
    least_mm: f64,
    greatest_mm: f64,
    end_mm: f64,
}

/// The threads cut since power-on, and the one being cut.
#[derive(Clone, Debug)]
pub struct ThreadRecorder {
    measured: Option<ThreadMeasurement>,
    threads: Vec<ThreadCut>,
}

impl Default for ThreadRecorder {
    fn default() -> Self {
        Self { measured: None, threads: Vec::with_capacity(MAX_THREADS) }
    }
}

impl ThreadRecorder {
    /// A thread begins: its line, its lead, and Z at its start, mm.
    pub const fn begin(&mut self, line: u32, lead_mm: f64, start_mm: f64) {
        let (least_mm, greatest_mm) = (f64::INFINITY, f64::NEG_INFINITY);
        let end_mm = start_mm;
        self.measured = Some(ThreadMeasurement { line, lead_mm, start_mm, least_mm, greatest_mm, end_mm });
    }

    /// One tick of cutting: Z from its encoder, and where it belongs by the spindle encoder, mm; `None` in the run-out.
    pub fn measure(&mut self, actual: f64, nominal: Option<f64>) {
        let Some(measured) = &mut self.measured else { return };
        // Note 5: the run-up must be over after three leads; measure from there in any case.
        let far = (actual - measured.start_mm).abs() >= APPROACH_LEADS * measured.lead_mm;
        if let Some(belongs) = nominal.filter(|_| far) {
            let off = actual - belongs;
            measured.least_mm = measured.least_mm.min(off);
            measured.greatest_mm = measured.greatest_mm.max(off);
            measured.end_mm = actual;
        }
    }

    /// No thread is being cut: records the last one.
    pub fn finish(&mut self) {
        let Some(measured) = self.measured.take() else { return };
        if measured.greatest_mm >= measured.least_mm && self.threads.len() < MAX_THREADS {
            self.threads.push(ThreadCut {
                line: measured.line,
                lead_mm: measured.lead_mm,
                length_mm: (measured.end_mm - measured.start_mm).abs(),
                error_mm: measured.greatest_mm - measured.least_mm,
            });
        }
    }

    /// The threads cut since power-on with their lead error, mm; at most 256.
    #[must_use]
    pub fn threads(&self) -> &[ThreadCut] {
        &self.threads
    }
}
