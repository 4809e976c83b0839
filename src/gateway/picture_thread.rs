//! Paints the screen for those who look at it from elsewhere, on a thread of its own, at most once a second and only while
//! somebody asks.

use std::time::Duration;

use crossbeam_channel::{Receiver, Sender, bounded};

use crate::link::snapshot::Snapshot;

/// Least time between two pictures.
const PICTURE_INTERVAL: Duration = Duration::from_secs(1);

/// A picture that is older is not that of the machine now.
const LONGEST_AGE: Duration = Duration::from_secs(3);

/// Paints a snapshot as a PNG file; `None` if it cannot be painted.
pub type Painter = Box<dyn FnMut(&Snapshot) -> Option<Vec<u8>> + Send>;

/// The thread, and its newest picture.
pub struct PictureThread {
    /// What is to be painted, and when it was asked for.
    asks: Sender<(Box<Snapshot>, Duration)>,
    pictures: Receiver<(Vec<u8>, Duration)>,
    /// The newest picture, and when it was asked for.
    newest: Option<(Vec<u8>, Duration)>,
    asked_at: Option<Duration>,
}

impl PictureThread {
    /// Starts it; `None` if the system cannot create a thread. It ends when this is dropped.
    #[must_use]
    pub fn start(mut painter: Painter) -> Option<Self> {
        let (asks, asked) = bounded::<(Box<Snapshot>, Duration)>(1);
        let (painted, pictures) = bounded(1);
        let paint = move || {
            for (snapshot, at) in asked {
                let sent = painter(&snapshot).is_none_or(|picture| painted.send((picture, at)).is_ok());
                if !sent {
                    return;
                }
            }
        };
        std::thread::Builder::new().name("kt830-picture".to_owned()).spawn(paint).ok()?;
        Some(Self { asks, pictures, newest: None, asked_at: None })
    }

    /// Takes a finished picture.
    pub fn step(&mut self) {
        if let Ok(picture) = self.pictures.try_recv() {
            self.newest = Some(picture);
        }
    }

    /// Whether the next picture may be asked for.
    #[must_use]
    pub fn is_due(&self, now: Duration) -> bool {
        self.asks.is_empty() && self.asked_at.is_none_or(|at| now.saturating_sub(at) >= PICTURE_INTERVAL)
    }

    /// Asks for the next picture. A thread that has ended paints no more.
    pub fn ask(&mut self, now: Duration, snapshot: Snapshot) {
        self.asked_at = Some(now);
        drop(self.asks.try_send((Box::new(snapshot), now)));
    }

    /// The newest picture, unless it is old.
    #[must_use]
    pub fn newest(&self, now: Duration) -> Option<&[u8]> {
        let (picture, asked_at) = self.newest.as_ref()?;
        (now.saturating_sub(*asked_at) <= LONGEST_AGE).then_some(picture)
    }
}
