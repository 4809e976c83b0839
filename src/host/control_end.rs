//! The end of a control on a thread, requested from any other thread. Source: safety stance.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Longest wait for the control: braking, and storing on a slow disk.
const MAX_WAIT: Duration = Duration::from_secs(10);

/// Ends a control on a thread, from any thread.
#[derive(Clone, Debug, Default)]
pub struct ControlEnd {
    pub(super) stop: Arc<AtomicBool>,
    ended: Arc<(Mutex<bool>, Condvar)>,
}

impl ControlEnd {
    /// Ends the control and waits until its outputs are safe and its data stored; false after ten seconds.
    pub fn end(&self) -> bool {
        self.stop.store(true, Ordering::Release);
        let (ended, changed) = &*self.ended;
        let waiting = ended.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = changed.wait_timeout_while(waiting, MAX_WAIT, |ended| !*ended);
        *waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Whether the end was requested.
    #[must_use]
    pub fn is_requested(&self) -> bool {
        self.stop.load(Ordering::Acquire)
    }

    /// The control has ended.
    pub(super) fn set_ended(&self) {
        let (ended, changed) = &*self.ended;
        *ended.lock().unwrap_or_else(PoisonError::into_inner) = true;
        changed.notify_all();
    }
}
