//! What makes the core run: folders and data on disk, the headless rig, the real-time thread and the disk thread.
//! The only room with a clock and threads.

pub mod bar;
pub mod disk;
pub mod disk_thread;
pub mod keeper;
pub mod realtime;
pub mod rig;
pub mod vault;
