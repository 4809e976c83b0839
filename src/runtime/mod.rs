//! What makes the core run: folders and data on disk, the headless rig, the real-time thread.

pub mod disk;
pub mod keeper;
pub mod rig;
