//! Runs the core: folders and data on disk, the headless rig, the real-time thread and the disk thread.
//! The only room with a clock and threads.

pub mod bar;
pub mod clock;
pub mod disk;
pub mod disk_thread;
pub mod draw;
pub mod keeper;
pub mod office;
mod page_file;
pub mod realtime;
pub mod rig;
mod screws;
pub mod serial;
mod shipped;
pub mod simulator;
pub mod transfer;
pub mod values;
pub mod vault;
