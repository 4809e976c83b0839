//! Data that survive a power cut, and the folders into which the operator copies files.
//!
//! Synchronous code for the disk thread, never for the tick: every call may wait for the disk. This room does not know
//! the meaning of a variable or a program; it stores data and returns them complete, or reports what is wrong.
//!
//! | data | where | how they survive a power cut |
//! |---|---|---|
//! | variables, parameters, tool and work offsets, texts | [`RetainedDatabase`], `retained.redb` | one durable transaction a commit |
//! | settings, backups, part files | [`ron_file`] | atomic replacement, checksum, previous version kept |
//! | programs, page files, pictures | [`Folder`] | atomic replacement |
//!
//! Source: spec K3, K4.2, K6, K7.3, K7.8, B1, B3, B6.

mod atomic_file;
mod checksum;
mod data_dir;
mod decode;
pub mod disk;
mod file_class;
mod folder;
mod folder_watch;
mod io_fault;
mod language_files;
mod listing;
mod named_program;
pub mod password;
mod program_folder;
mod retained;
pub mod ron_file;
mod settings;
mod usb_drive;
mod values;

pub use atomic_file::{
    folder_of, is_temporary, remove_temporary, replace as write_atomic, replace_private as write_private,
};
pub use checksum::checksum as stamp;
pub use data_dir::{DataDir, DataDirError};
pub use decode::{DecodeError, Decoded, Encoding, decode, encode};
pub use file_class::{
    CommentSource, FileClass, PAGE_FILES, PAGE_TEXT, PAGE_TEXT_EN, PAGE_TEXT_LIMIT, PICTURE, PICTURE_LABELS,
    PICTURE_LIMIT, PROGRAM, PROGRAM_LIMIT, PROGRAMS_LIMIT, TEXT_LIMIT,
};
pub use folder::{FileContent, Folder, FolderError, read_regular_file};
pub use folder_watch::{FolderChange, FolderWatch, POLL_INTERVAL};
pub use io_fault::IoFault;
pub use language_files::{AddedLanguages, MAX_ADDED_LANGUAGES};
pub use listing::{FolderEntry, FolderListing, IgnoredFile, LISTING_LIMIT};
pub use named_program::{NamedProgram, list_named_programs, program_stem};
pub use program_folder::{ProgramFolder, STEM_LIMIT};
pub use retained::{
    DATABASE_FILE, DamageReport, Generation, KIND_FILE, OpenedDatabase, PASSWORD_FILE, REAL_MACHINE_MARK,
    RetainedChange, RetainedData, RetainedDatabase, RetainedError, StorageFault, ToolOffset, generations,
    run_database_check, set_check_program, silence_database_check,
};
pub use settings::{StoredLang, StoredSettings};
pub use usb_drive::{ListedFile, UsbDrive};
pub use values::Values;
