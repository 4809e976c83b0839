//! `kt830 shot`: paints a page to a file without a display.
//! Source: spec tools.md T6.

use std::path::Path;

use super::args::{SharedArgs, ShotArgs};
use super::play::read_story;
use super::{CallError, FAILED, SUCCESS, setup};
use crate::defs::program_number;
use crate::hmi::offscreen::OffscreenHmi;
use crate::link::command::Command;
use crate::story::play::state_report;

/// Ticks until a page is complete.
const SETTLE_TICKS: u32 = 5;

/// Paints the page.
///
/// # Errors
/// The call or a file is wrong.
pub fn shot(shared: &SharedArgs, call: &ShotArgs) -> Result<u8, CallError> {
    let told = call.story.as_deref().map(|path| read_story(path, shared.kind)).transpose()?;
    let kind = told.as_ref().map_or(shared.kind, |story| story.kind);
    let shared = SharedArgs { kind, light: shared.light || call.light, ..shared.clone() };
    if !call.page.exists_on(kind) {
        return Err(CallError::new(format!("page {}: a machine of kind {} has none", call.page.id(), kind.id())));
    }
    let mut host = setup::headless_host(&shared)?;
    host.send(Command::WallClock(call.clock));
    match &told {
        Some(told) => {
            let mut player = told.player(&mut host, shared.lang, shared.part.is_some());
            for line in &told.lines {
                if let Err(why) = player.play(line) {
                    let (path, state) =
                        (call.story.as_deref().unwrap_or(Path::new(".")), state_report(player.host(), shared.lang));
                    warn_line!("{}:{}: {}: {why}\n{state}", path.display(), line.number, line.text);
                    return Ok(FAILED);
                }
            }
        }
        None => {
            let number = program_number::from_name(kind.ui().picture_program);
            setup::make_ready_for(&mut host, &shared, number)?;
        }
    }
    host.send(Command::OpenPage(call.page));
    (0..SETTLE_TICKS).for_each(|_| host.step());
    // A page may send requests when it opens: the drawing its toolpath, the transfer page its media.
    let mut stage = OffscreenHmi::new(setup::screen(&shared), call.size);
    for _ in 0..SETTLE_TICKS {
        let commands = stage.frame(host.snapshot());
        commands.into_iter().for_each(|command| host.send(command));
        (0..SETTLE_TICKS).for_each(|_| host.step());
    }
    stage.frame(host.snapshot());
    let out = &call.out;
    stage.picture().save(out).map_err(CallError::at(format!("--out {}", out.display())))?;
    Ok(SUCCESS)
}
