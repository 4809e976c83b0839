//! `kt830 demo`: plays a story for spectators. On a display it plays in real time and hands over at the first touch;
//! without a display it plays as fast as possible and writes pictures.
//! Source: spec tools.md T2.

use std::path::Path;

use super::args::{Demo, Shared};
use super::play::{Story, story};
use super::{CallError, FAILED, FINE, bench, out};
use crate::runtime::rig::Rig;
use crate::story::{Player, Statement, parse, play::around};

/// The default story.
const USUAL: &str = include_str!("../../assets/stories/first_part.story");
/// The stories of the other kinds; each names its kind in the first line.
const OTHERS: [&str; 4] = [
    include_str!("../../assets/stories/first_part_gs.story"),
    include_str!("../../assets/stories/first_part_ga.story"),
    include_str!("../../assets/stories/vertical.story"),
    include_str!("../../assets/stories/shaft.story"),
];

/// Plays the story.
///
/// # Errors
/// The call or a file is wrong.
pub fn demo(shared: &Shared, call: &Demo) -> Result<u8, CallError> {
    let told = match &call.story {
        Some(path) => story(path, shared.kind)?,
        None => {
            let mut told = parse(USUAL, shared.kind).map_err(CallError::new)?;
            for other in OTHERS {
                let (kind, lines) = parse(other, shared.kind).map_err(CallError::new)?;
                if shared.kind_asked == Some(kind) {
                    told = (kind, lines);
                }
            }
            Story { kind: told.0, lines: told.1 }
        }
    };
    let shared = Shared { kind: told.kind, ..shared.clone() };
    let rig = bench::rig(&shared)?;
    #[cfg(feature = "hmi")]
    if super::window::has_display() {
        return live::play(&shared, told, rig);
    }
    headless(&shared, call, &told, rig)
}

fn headless(shared: &Shared, call: &Demo, told: &Story, mut rig: Rig) -> Result<u8, CallError> {
    if let Some(folder) = &call.out {
        std::fs::create_dir_all(folder)
            .map_err(|error| CallError::new(format!("--out {}: {error}", folder.display())))?;
    }
    let folder = call.story.as_deref().and_then(Path::parent).unwrap_or(Path::new("."));
    let mut player = Player::new(&mut rig, super::eyes::eyes(shared.lang), folder, false);
    let mut visited = Vec::new();
    for line in &told.lines {
        let done = player.play(line);
        let seconds = player.rig().now().as_secs_f64();
        match done {
            Ok(()) => out(format!("{seconds:10.3}  {}", line.text)),
            Err(why) => {
                out(format!("{seconds:10.3}  FAIL  {}: {why}", line.text));
                eprintln!("{}", around(player.rig()));
                return Ok(FAILED);
            }
        }
        if let Statement::Page(page) = line.statement
            && !visited.contains(&page)
        {
            visited.push(page);
        }
        if matches!(line.statement, Statement::WaitUntil(..)) {
            picture(shared, call, player.rig(), line.number)?;
        }
    }
    for page in visited {
        player.rig().send(crate::link::command::Command::OpenPage(page));
        player.rig().step();
        picture(shared, call, player.rig(), 0)?;
    }
    drop(player);
    let part = rig.machine().measure();
    for at in &part.diameters {
        out(format!("part diameter at Z{:.3}  {:.4}", at.z, at.d));
    }
    for at in &part.faces {
        out(format!("part face at X{:.3}  Z {:.4}", at.x, at.z));
    }
    Ok(FINE)
}

/// Writes a picture of the open page to the folder of the call.
fn picture(shared: &Shared, call: &Demo, rig: &mut Rig, line: u32) -> Result<(), CallError> {
    #[cfg(feature = "hmi")]
    if let Some(folder) = &call.out {
        let snapshot = rig.snapshot();
        let name = match line {
            0 => format!("{}.png", snapshot.page.id()),
            line => format!("{}-line-{line:03}.png", snapshot.page.id()),
        };
        let path = folder.join(name);
        let painted = crate::hmi::shot(snapshot, shared.lang, (1_024, 768));
        painted.save(&path).map_err(|error| CallError::new(format!("{}: {error}", path.display())))?;
    }
    #[cfg(not(feature = "hmi"))]
    let _ = (shared, call, rig, line);
    Ok(())
}

#[cfg(feature = "hmi")]
mod live {
    //! The story on a display.

    use std::path::Path;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::super::args::Shared;
    use super::super::play::Story;
    use super::super::{CallError, window};
    use crate::link::snapshot::RunState;
    use crate::runtime::rig::Rig;
    use crate::story::Player;
    use crate::units::Micros;

    /// Without input for this time the story starts again.
    const IDLE: Micros = Micros::from_millis(60_000);
    /// Pause between two runs of the story.
    const PAUSE: Micros = Micros::from_millis(5_000);

    pub fn play(shared: &Shared, told: Story, mut rig: Rig) -> Result<u8, CallError> {
        let (desk, beside) = window::story_desk(rig.snapshot().clone());
        let over = Arc::new(AtomicBool::new(false));
        let ended = Arc::clone(&over);
        rig.accompany(Box::new(beside));
        let thread = std::thread::Builder::new().name("kt830-story".into()).spawn(move || {
            while !ended.load(Ordering::Acquire) {
                show(&mut rig, &told, &ended);
            }
        });
        let thread = thread.map_err(CallError::new)?;
        let closed = window::show(Box::new(desk), shared, false);
        over.store(true, Ordering::Release);
        drop(thread.join());
        closed
    }

    /// Plays the story once. A touch stops it; then this waits until there is no input.
    fn show(rig: &mut Rig, told: &Story, over: &AtomicBool) {
        rig.power_on();
        rig.take_touch();
        let mut player = Player::new(rig, None, Path::new("."), false);
        for line in &told.lines {
            let touched = player.rig().is_touched();
            if touched || over.load(Ordering::Acquire) {
                break;
            }
            // A demo continues when an expectation fails.
            drop(player.play(line));
        }
        drop(player);
        let touched = rig.is_touched();
        let mut quiet_since = rig.now();
        let quiet = if touched { IDLE } else { PAUSE };
        while !over.load(Ordering::Acquire) {
            rig.step();
            if rig.take_touch() || rig.controller().state() == RunState::Running {
                quiet_since = rig.now();
            }
            if rig.now().since(quiet_since) > quiet {
                return;
            }
        }
    }
}
