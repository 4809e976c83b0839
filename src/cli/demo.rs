//! `kt830 demo`: plays a story for spectators. On a display it plays in real time and hands over at the first touch;
//! without a display it plays as fast as possible and writes pictures.
//! Source: spec tools.md T2.

use super::args::{DemoArgs, SharedArgs};
use super::play::{StoryFile, demo_story, film_stories, read_story};
use super::run::size_lines;
use super::story_loop::Film;
use super::{CallError, FAILED, SUCCESS, print_line, setup};
use crate::host::headless::HeadlessHost;
use crate::story::{Statement, play::state_report};

/// Plays the story.
///
/// # Errors
/// The call or a file is wrong.
pub fn demo(shared: &SharedArgs, call: &DemoArgs) -> Result<u8, CallError> {
    let has_spectators = call.record.is_some() || has_display();
    let stories = match &call.story {
        Some(path) => vec![read_story(path, shared.kind)?],
        None if has_spectators => film_stories(shared)?,
        None => vec![demo_story(shared)?],
    };
    let film = Film { shared: shared.clone(), stories };
    #[cfg(feature = "hmi")]
    if let Some(folder) = &call.record {
        return super::film::record(&film, folder, call.fps);
    }
    #[cfg(not(feature = "hmi"))]
    if call.record.is_some() {
        return Err(CallError::new("--record: this build has no screen, build it with the feature hmi"));
    }
    #[cfg(feature = "hmi")]
    if has_spectators {
        return live::play(film, !call.windowed);
    }
    film.stories.first().map_or(Ok(SUCCESS), |told| headless(&film.call_for(told), call, told))
}

#[cfg(feature = "hmi")]
use super::window::has_display;

#[cfg(not(feature = "hmi"))]
const fn has_display() -> bool {
    false
}

fn headless(shared: &SharedArgs, call: &DemoArgs, told: &StoryFile) -> Result<u8, CallError> {
    let mut host = setup::headless_host(shared)?;
    if let Some(folder) = &call.out {
        std::fs::create_dir_all(folder).map_err(CallError::at(format!("--out {}", folder.display())))?;
    }
    let mut player = told.player(&mut host, shared.lang, false);
    let mut visited = Vec::new();
    for line in &told.lines {
        let done = player.play(line);
        let seconds = player.host().now().as_secs_f64();
        match done {
            Ok(()) => print_line(format!("{seconds:10.3}  {}", line.text)),
            Err(why) => {
                print_line(format!("{seconds:10.3}  FAIL  {}: {why}", line.text));
                warn_line!("{}", state_report(player.host(), shared.lang));
                return Ok(FAILED);
            }
        }
        if let Statement::Page(page) = line.statement
            && !visited.contains(&page)
        {
            visited.push(page);
        }
        if matches!(line.statement, Statement::WaitUntil(..)) {
            picture(shared, call, player.host(), line.number)?;
        }
    }
    for page in visited {
        player.host().send(crate::link::command::Command::OpenPage(page));
        player.host().step();
        picture(shared, call, player.host(), 0)?;
    }
    drop(player);
    size_lines(&host.machine().measure()).for_each(print_line);
    Ok(SUCCESS)
}

/// Writes a picture of the open page to the folder of the call.
fn picture(shared: &SharedArgs, call: &DemoArgs, host: &mut HeadlessHost, line: u32) -> Result<(), CallError> {
    #[cfg(feature = "hmi")]
    if let Some(folder) = &call.out {
        let snapshot = host.snapshot();
        let name = match line {
            0 => format!("{}.png", snapshot.page.id()),
            line => format!("{}-line-{line:03}.png", snapshot.page.id()),
        };
        let path = folder.join(name);
        let painted = crate::hmi::screenshot(snapshot, shared.lang, (1_024, 768));
        painted.save(&path).map_err(CallError::at(path.display()))?;
    }
    #[cfg(not(feature = "hmi"))]
    let _ = (shared, call, host, line);
    Ok(())
}

#[cfg(feature = "hmi")]
mod live {
    //! The story on a display.

    use super::super::story_loop::{self, Film};
    use super::super::{CallError, SUCCESS, serve, setup, window};
    use crate::host::thread::start;

    pub fn play(film: Film, fullscreen: bool) -> Result<u8, CallError> {
        let Some(first) = film.stories.first() else { return Ok(SUCCESS) };
        let (shared, is_one_machine) = (film.call_for(first), film.stories.len() == 1);
        let host = setup::threaded_host(&shared, false, setup::simulated_for_display)?;
        let mut link = start(host, move |thread| story_loop::repeat(thread, &film)).map_err(CallError::new)?;
        // Clients know one machine.
        let _network = is_one_machine.then(|| serve::start_network(&mut link, &shared)).transpose()?;
        window::show(link, &shared, fullscreen)
    }
}
