//! The buzzer of a panel computer: tones on the sound device of Linux' input layer (pcspkr), from a thread of its own, so that
//! none delays anything. A computer without one is silent.
//! Source: issue "the face", part 10; Linux, include/uapi/linux/input-event-codes.h.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use crossbeam_channel::{Sender, bounded};

/// The sound device of the PC speaker.
const DEVICE: &str = "/dev/input/by-path/platform-pcspkr-event-spkr";
/// An event of a tone, and its frequency, Hz; 0 ends it.
const EV_SND: u16 = 0x12;
const SND_TONE: u16 = 0x02;
/// Tones that wait while one is played.
const QUEUE: usize = 2;

/// A note: frequency, Hz (0: a pause), and how long.
pub type Note = (u32, Duration);

/// A buzzer on its thread. Dropping it ends the thread.
pub struct Buzzer {
    notes: Sender<&'static [Note]>,
}

impl Buzzer {
    /// The buzzer of this computer; none if it has none, or this user may not use it.
    #[must_use]
    pub fn open() -> Option<Self> {
        Self::at(Path::new(DEVICE))
    }

    /// The buzzer at a device file.
    #[must_use]
    pub fn at(device: &Path) -> Option<Self> {
        let device: PathBuf = device.to_owned();
        let file = OpenOptions::new().write(true).open(device).ok()?;
        let (notes, played) = bounded::<&'static [Note]>(QUEUE);
        let play = move || {
            let mut file = file;
            for notes in played {
                notes.iter().for_each(|note| play_note(&mut file, *note));
            }
        };
        thread::Builder::new().name("kt830-buzzer".into()).spawn(play).ok()?;
        Some(Self { notes })
    }

    /// Plays notes, or drops them if others wait.
    pub fn play(&self, notes: &'static [Note]) {
        let _ = self.notes.try_send(notes);
    }
}

/// A device that has gone is silent.
fn play_note(file: &mut File, (hertz, length): Note) {
    let _ = file.write_all(&tone_event(hertz));
    thread::sleep(length);
    let _ = file.write_all(&tone_event(0));
}

/// `struct input_event`: a time, which the kernel sets, type, code, value.
fn tone_event(hertz: u32) -> Vec<u8> {
    let mut event = vec![0; 2 * size_of::<usize>()];
    event.extend(EV_SND.to_ne_bytes());
    event.extend(SND_TONE.to_ne_bytes());
    event.extend(hertz.to_ne_bytes());
    event
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn h8_a_note_begins_and_ends_a_tone() {
        let folder = tempfile::tempdir().unwrap();
        let device = folder.path().join("speaker");
        assert!(Buzzer::at(&device).is_none(), "no device");
        std::fs::write(&device, "").unwrap();
        let buzzer = Buzzer::at(&device).unwrap();
        const NOTES: &[Note] = &[(880, Duration::from_millis(1)), (0, Duration::ZERO)];
        buzzer.play(NOTES);
        drop(buzzer.notes);
        let wanted: Vec<u8> = [880, 0, 0, 0].into_iter().flat_map(tone_event).collect();
        let begun = std::time::Instant::now();
        while std::fs::read(&device).unwrap() != wanted {
            assert!(begun.elapsed() < Duration::from_secs(30), "{:?}", std::fs::read(&device));
            thread::yield_now();
        }
        // 64-bit Linux: 16 bytes of time, then 0x12, 2, 880 = 0x370.
        if cfg!(all(target_endian = "little", target_pointer_width = "64")) {
            assert_eq!(wanted[16..24], [0x12, 0, 2, 0, 0x70, 0x03, 0, 0]);
        }
    }
}
