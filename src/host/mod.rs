//! Runs the core: folders and data on disk, the headless rig, the real-time thread and the disk thread.
//! The only room with a clock and threads.

pub mod bar;
pub mod clock;
pub mod folders;
pub mod headless;
pub mod job_runner;
mod leadscrew_files;
mod page_file;
pub mod password_store;
pub mod realtime;
pub mod retained_store;
pub mod serial;
mod shipped;
pub mod simulation_control;
pub mod storage_thread;
pub mod toolpath;
pub mod transfer;
pub mod value_set;
