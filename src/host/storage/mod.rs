//! What the control asks of disk and background: retained data, passwords, jobs, programs and page files, the part of
//! a program. One worker carries the requests out, either in the step or on threads of its own.
//! Source: spec B1, B3, B6, K7.3; notes "reliability".

pub mod direct;
pub mod threaded;
mod worker;

use std::sync::Arc;

pub use direct::DirectStorage;
pub use threaded::ThreadedStorage;
pub use worker::{RetainedWorker, StorageWorker};

use super::part::PartQuery;
use crate::controller::{Programs, StorageRequest};
use crate::io::sim::PartFile;
use crate::link::command::Command;
use crate::link::snapshot::DirectoryRow;

/// What storage delivers to the host.
pub enum Arrival {
    /// An answer, new page files or the time of day.
    Command(Command),
    /// The programs of the folder, and the directory as shown.
    Programs(Arc<Programs>, Arc<Vec<DirectoryRow>>),
    /// The answer to [`Storage::find_part`]; `None` for a program without a part.
    Part(Option<Box<PartFile>>),
}

/// The disk and background work of one control. No duty is inherited.
pub trait Storage {
    /// Takes requests without waiting. Requests that cannot be taken now stay in `requests`.
    fn submit(&mut self, requests: &mut Vec<StorageRequest>);
    /// Asks for the part of a program; the answer is an [`Arrival::Part`]. False if the question cannot be taken now.
    fn find_part(&mut self, query: PartQuery) -> bool;
    /// Moves what has come since the last call to `arrivals`, in order: changed programs come before the answer of the
    /// job that changed them.
    fn poll(&mut self, arrivals: &mut Vec<Arrival>);
    /// Stores what was submitted and ends; called once, after the last tick.
    fn close(&mut self);
}
