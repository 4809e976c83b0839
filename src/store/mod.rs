//! Data that survive a power cut, and the folders into which the operator copies files.
//!
//! Synchronous code for the disk thread, never for the tick: every call may wait for the disk. This room does not know
//! the meaning of a variable or a program; it stores data and returns them complete, or reports what is wrong.
//!
//! | data | where | how they survive a power cut |
//! |---|---|---|
//! | variables, parameters, offsets, frames, texts | [`Retained`], `retained.redb` | one durable transaction a commit |
//! | settings, backups, part files | [`ron_file`] | atomic replacement, checksum, previous version kept |
//! | programs, page files, pictures | [`Folder`] | atomic replacement |
//!
//! Source: spec K3, K4.2, K6, K7.3, K7.8, B1, B3, B6.

mod checksum;
mod data_dir;
mod decode;
mod fault;
mod file_class;
mod folder;
mod listing;
mod named;
pub mod password;
mod retained;
pub mod ron_file;
mod settings;
mod shelf;
mod stick;
mod values;
mod watch;
mod whole_file;

pub use checksum::of as stamp;
pub use data_dir::{DataDir, DataDirError};
pub use decode::{DecodeError, Decoded, Encoding, decode};
pub use fault::IoFault;
pub use file_class::{
    CommentIs, FileClass, PAGE_TEXT, PAGE_TEXT_LIMIT, PICTURE, PICTURE_LIMIT, PROGRAM, PROGRAM_LIMIT,
};
pub use folder::{Folder, FolderError, Read};
pub use listing::{Entry, Ignored, LISTING_LIMIT, Listing};
pub use named::{NamedEntry, list_named, stem_of};
pub use retained::{
    Change, DamageReport, Generation, Loaded, Opened, Retained, RetainedError, StorageFault, ToolOffset,
};
pub use settings::Settings;
pub use shelf::{STEM_LIMIT, Shelf};
pub use stick::{Stick, StickFile, read_whole, write_whole};
pub use values::Values;
pub use watch::{Changed, POLL_INTERVAL, Watch};
