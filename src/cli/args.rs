//! The arguments of the command line.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use clap::{Args as ClapArgs, Parser, Subcommand, ValueEnum};

use crate::defs::date::DateTime;
use crate::defs::favourite::Favourite;
use crate::defs::kind::Kind;
use crate::defs::page::Page;
use crate::defs::param::ParamAddress;
use crate::defs::text::{Lang, LocalizedText, Translation};
use crate::link::page_command::ZOOMS;
use crate::units::{Axis, Micros};

/// KT-830: a CNC control for grinding machines. Without a command it opens the control full-screen.
#[derive(Debug, Parser)]
#[command(name = "kt830", version, about, propagate_version = true)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub verb: Option<CliCommand>,
    /// Options of every command.
    #[command(flatten)]
    pub shared: SharedArgs,
    /// Open the control in a window.
    #[arg(long)]
    pub windowed: bool,
}

/// Options of every command.
#[derive(Clone, Debug, ClapArgs)]
pub struct SharedArgs {
    /// Kind of machine.
    #[arg(help = kind_help(), long = "kind", global = true, value_name = "KIND", value_parser = kind)]
    pub requested_kind: Option<Kind>,
    /// The kind that holds: asked for, else stored, else gc.
    #[arg(skip)]
    pub kind: Kind,
    /// Folder of retained data [default: the platform's data directory]
    #[arg(long, global = true, value_name = "DIR")]
    pub data: Option<PathBuf>,
    /// Folder of page texts and pictures [default: ./screens, else the data directory's]
    #[arg(long, global = true, value_name = "DIR")]
    pub screens: Option<PathBuf>,
    /// Folder of programs [default: ./programs, else the data directory's]
    #[arg(long, global = true, value_name = "DIR")]
    pub programs: Option<PathBuf>,
    /// Language: zh, en, or that of a language file [default: as set on the machine, else zh]
    #[arg(long = "lang", global = true, value_name = "LANG")]
    pub requested_lang: Option<String>,
    /// Folder of language files [default: the data directory's]
    #[arg(long, global = true, value_name = "DIR")]
    pub languages: Option<PathBuf>,
    /// The languages of those files.
    #[arg(skip)]
    pub added_languages: Vec<&'static Translation>,
    /// Something is wrong with one of them.
    #[arg(skip)]
    pub has_language_faults: bool,
    /// The language that holds: asked for, else stored, else Chinese.
    #[arg(skip)]
    pub lang: Lang,
    /// What is wrong with the settings of the data directory.
    #[arg(skip)]
    pub settings_fault: Option<LocalizedText>,
    /// The light theme, as set on the machine.
    #[arg(skip)]
    pub light: bool,
    /// Brightness of the picture in percent, as set on the machine.
    #[arg(skip = 100)]
    pub brightness: u8,
    /// Size of the screen in percent: 100, 150 or 200 [default: as set on the machine]
    #[arg(long = "zoom", global = true, value_name = "PERCENT", value_parser = zoom)]
    pub zoom: Option<u16>,
    /// What the home page keeps, as set on the machine.
    #[arg(skip)]
    pub favourites: Vec<Favourite>,
    /// Set a parameter, for example P270=0; may be repeated
    #[arg(long = "param", global = true, value_name = "P=VALUE", value_parser = param)]
    pub params: Vec<(ParamAddress, f64)>,
    /// Set a macro variable, for example '#500=40.2'; may be repeated
    #[arg(long = "set", global = true, value_name = "#N=VALUE", value_parser = variable, allow_hyphen_values = true)]
    pub sets: Vec<(u16, f64)>,
    /// Folder used as the USB medium [default: the medium that is plugged in]
    #[arg(long, global = true, value_name = "DIR")]
    pub usb: Option<PathBuf>,
    /// RS232 port, such as /dev/ttyS0 or COM1 [default: as set on the machine]
    #[arg(long, global = true, value_name = "PORT")]
    pub serial: Option<String>,
    /// Part file of the simulated machine
    #[arg(long, global = true, value_name = "FILE")]
    pub part: Option<PathBuf>,
    /// The machine: the description of a real one, for the control itself alone, or a simulated one: a machine file, or
    /// a variation of the machine of the kind [default: machine.ron in the data directory, else the simulated machine]
    #[arg(long, global = true, value_name = "FILE")]
    pub machine: Option<PathBuf>,
    /// Seed of the random numbers of the simulated machine
    #[arg(long, global = true, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Output format
    #[arg(long, global = true, value_enum, default_value_t = OutputFormat::Text)]
    pub format: OutputFormat,
}

/// Form of the results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum OutputFormat {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum CliCommand {
    /// Open the control and play a story on the simulated machine
    Demo(DemoArgs),
    /// Run a program on the simulated machine, as fast as possible
    Run(RunArgs),
    /// Check programs, page texts and pictures without running them
    Check(CheckArgs),
    /// Play a story and print the result of each line
    Play(PlayArgs),
    /// Show, import or clear the table of a ball screw (backlash and pitch error over position)
    Screw(LeadscrewArgs),
    /// Paint a page to a PNG file
    Shot(ShotArgs),
    /// Run a program and draw its path: contour, band, speed, acceleration, jerk
    PlotPath(PlotPathArgs),
    /// Look at the field bus of a real machine: devices, inputs, drives; nothing is switched on
    Bus(BusArgs),
    /// Grind parts with every program on many different machines, and tell which are good
    Qualify(QualifyArgs),
    /// Let random operators, faults and power cuts work on a simulated control and check what must always hold
    Torture(TortureArgs),
    /// Print the texts of the control as a language file, or bring one up to date
    Texts(TextsArgs),
    /// Print the table of the language: codes, words, functions and system variables of a kind of machine
    Codes,
    /// Run a simulated control without a screen, at the pace of the clock, with its network services (P480)
    Serve(ServeArgs),
    /// Run many simulated controls against one broker, to see whether it bears them and that no result is lost
    Fleet(FleetArgs),
    /// Show a control to clients of OPC UA, in a process of its own; its users and certificates
    #[command(name = "opcua")]
    OpcUa(OpcUaArgs),
    /// Set the password of those who look from other computers (P486); it is read from standard input
    WebAccess(WebAccessArgs),
    /// Print the model of the machine for an agent of MTConnect (Devices.xml)
    DeviceModel,
    /// Inspect the database on standard input, with little memory and time: the control calls it before it opens one
    #[command(hide = true)]
    CheckDatabase,
}

/// `kt830 texts`
#[derive(Debug, ClapArgs)]
pub struct TextsArgs {
    /// A language file: its words stay, new texts are added without words, and what is wrong is told [default: all texts
    /// without words]
    #[arg(value_name = "FILE.ron")]
    pub file: Option<PathBuf>,
}

/// `kt830 bus`
#[derive(Debug, ClapArgs)]
pub struct BusArgs {
    /// Description of the machine
    #[arg(value_name = "MACHINE")]
    pub description: PathBuf,
    /// How long to watch, seconds
    #[arg(long = "for", value_name = "SECONDS", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=86_400))]
    pub seconds: u32,
}

/// `kt830 demo`
#[derive(Debug, ClapArgs)]
pub struct DemoArgs {
    /// The story [default: cold start to a ground, measured part]
    pub story: Option<PathBuf>,
    /// Folder for pictures of the pages visited; no display is needed
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Folder for the pictures of a film: frame-00001.png and on; no display is needed
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    pub record: Option<PathBuf>,
    /// Pictures of the film a second
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=60), requires = "record")]
    pub fps: u32,
    /// In a window; otherwise the demonstration has the whole display
    #[arg(long)]
    pub windowed: bool,
}

/// `kt830 run`
#[derive(Debug, ClapArgs)]
pub struct RunArgs {
    /// A program of the folder (O1002) or a file
    pub program: String,
    /// Continue through M00 without a stop
    #[arg(long)]
    pub through_stops: bool,
    /// Number of runs, each with a new part in the machine; the report lists every part
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub parts: u32,
    /// Write one line per tick: time, set and actual positions, outputs, block
    #[arg(long, value_name = "FILE.csv")]
    pub trace: Option<PathBuf>,
    /// Stop a part that takes longer than so many hours of simulated time
    #[arg(long, value_name = "N", default_value_t = USUAL_HOURS, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub hours: u32,
}

/// Longest simulated time of a part, h, unless the call names another.
pub const USUAL_HOURS: u32 = 8;

/// `kt830 check`
#[derive(Debug, ClapArgs)]
pub struct CheckArgs {
    /// Programs, page texts, pictures
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// Also run the programs on the simulated machine with their part
    #[arg(long)]
    pub simulate: bool,
    /// Print the canonical operations
    #[arg(long)]
    pub ops: bool,
}

/// `kt830 screw`
#[derive(Debug, ClapArgs)]
pub struct LeadscrewArgs {
    /// The axis: X, Y or Z
    #[arg(value_parser = axis)]
    pub axis: Axis,
    /// A table to import: one line per point, `position, backlash[, pitch error]`, mm, machine coordinates of the slide
    pub file: Option<PathBuf>,
    /// Clear the table
    #[arg(long, conflicts_with = "file")]
    pub clear: bool,
}

/// `kt830 serve`
#[derive(Debug, ClapArgs)]
pub struct ServeArgs {
    /// A story that is played again and again [default: the machine stands]
    pub story: Option<PathBuf>,
    /// End after this time, seconds [default: when it is ended from outside]
    #[arg(long, value_name = "SECONDS")]
    pub seconds: Option<u64>,
}

/// `kt830 fleet`
#[derive(Debug, ClapArgs)]
pub struct FleetArgs {
    /// A story that every machine plays again and again [default: cold start to a ground, measured part]
    pub story: Option<PathBuf>,
    /// The broker, HOST:PORT, without TLS
    #[arg(long, value_name = "HOST:PORT", default_value = "localhost:1883")]
    pub broker: String,
    /// Group of the machines
    #[arg(long, value_name = "NAME", default_value = "KT-830")]
    pub group: String,
    /// How many controls, 1 to 500; their numbers (P482) are 1, 2, 3 …
    #[arg(long, value_name = "NUMBER", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=500))]
    pub machines: u32,
    /// How long they work: 90, 90s, 10min, 2h
    #[arg(long = "for", alias = "seconds", value_name = "TIME", default_value = "60s", value_parser = seconds_of)]
    pub seconds: u64,
}

/// `kt830 web-access`
#[derive(Debug, ClapArgs)]
pub struct WebAccessArgs {
    /// Names and addresses under which browsers reach this computer, for the certificate of the control [default: localhost
    /// if there is no certificate yet]
    #[arg(value_name = "HOST")]
    pub hosts: Vec<String>,
}

/// `kt830 opcua`
#[derive(Debug, ClapArgs)]
pub struct OpcUaArgs {
    /// What to do.
    #[command(subcommand)]
    pub task: OpcUaTask,
}

/// The commands of `kt830 opcua`.
#[derive(Debug, Subcommand)]
pub enum OpcUaTask {
    /// Serve the control whose adapter port (P480) is named
    Serve(OpcUaServeArgs),
    /// Let a user in, or change the password of one; it is read from standard input
    AddUser {
        /// The name
        name: String,
        /// The user may propose orders to the operator
        #[arg(long)]
        orders: bool,
        /// The user may not any more; without either it stays as it was
        #[arg(long, conflicts_with = "orders")]
        no_orders: bool,
    },
    /// Let a user in no more
    RemoveUser {
        /// The name
        name: String,
    },
    /// Trust the certificate of a client no more
    Distrust {
        /// Its thumbprint, as `status` prints it
        thumbprint: String,
    },
    /// Print the users, and the certificates of clients that are trusted and that were refused
    Status,
    /// Trust the certificate of a client
    Trust {
        /// Its thumbprint, as `status` prints it of one that was refused, or a file
        certificate: String,
    },
}

/// `kt830 opcua serve`
#[derive(Debug, ClapArgs)]
pub struct OpcUaServeArgs {
    /// The adapter port of the control
    #[arg(long, value_name = "HOST:PORT", default_value = "127.0.0.1:7878")]
    pub control: String,
    /// Where it listens; 0.0.0.0:4840 is all networks of this computer
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:4840")]
    pub listen: std::net::SocketAddr,
    /// The name under which clients reach this computer
    #[arg(long, value_name = "NAME", default_value = "localhost")]
    pub host: String,
    /// End after this time, seconds [default: when it is ended from outside]
    #[arg(long, value_name = "SECONDS")]
    pub seconds: Option<u64>,
}

/// `kt830 play`
#[derive(Debug, ClapArgs)]
pub struct PlayArgs {
    /// The story
    pub story: PathBuf,
    /// Play to this simulated time and print the state, for example '12.5 s' or '800 ms'
    #[arg(long, value_name = "TIME", value_parser = time)]
    pub until: Option<Micros>,
    /// Write one line per tick: time, inputs, encoders, outputs, set-points
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
}

/// `kt830 shot`
#[derive(Debug, ClapArgs)]
pub struct ShotArgs {
    /// The page
    #[arg(value_parser = page)]
    pub page: Page,
    /// The file to write
    #[arg(long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Size of the screen in pixels
    #[arg(long, default_value = "1024x768", value_parser = size)]
    pub size: (u32, u32),
    /// Date and time of the clock at power-on
    #[arg(long, value_name = "DATE TIME", default_value = "2026-11-21 15:01:56", value_parser = clock)]
    pub clock: DateTime,
    /// A story that is played before the page is painted
    #[arg(long)]
    pub story: Option<PathBuf>,
    /// Paint in the light theme [default: as set on the machine, else dark]
    #[arg(long)]
    pub light: bool,
}

/// `kt830 qualify`
#[derive(Debug, ClapArgs)]
pub struct QualifyArgs {
    /// The programs: O1002 O1003 … [default: all that have a drawing; --programs all says the same]
    pub names: Vec<String>,
    /// Folder of machine files and variations [default: those that come with the control]
    #[arg(long, value_name = "DIR")]
    pub machines: Option<PathBuf>,
    /// Parts in a batch, one after the other
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub parts: u32,
    /// Batches of each program on each machine, each with its seed, from --seed on
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1_000))]
    pub seeds: u64,
}

/// `kt830 torture`
#[derive(Debug, ClapArgs)]
pub struct TortureArgs {
    /// Simulated time of each course, hours
    #[arg(long, value_name = "H", default_value_t = 1.0, value_parser = hours)]
    pub hours: f64,
    /// Number of courses; their seeds are --seed and the numbers after it. Without --kind the kinds take turns
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    pub courses: u64,
    /// Play this story, which a torture has written, instead of a random course
    #[arg(long, value_name = "STORY")]
    pub replay: Option<PathBuf>,
    /// Write the story of a broken rule, shortened, to this file
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `kt830 plot-path`
#[derive(Debug, ClapArgs)]
pub struct PlotPathArgs {
    /// A program of the folder (O1002) or a file
    pub program: String,
    /// The picture to write
    #[arg(long, value_name = "FILE.png")]
    pub out: PathBuf,
    /// Size of the picture in pixels
    #[arg(long, default_value = "1600x1000", value_parser = size)]
    pub size: (u32, u32),
    /// Draw only what the blocks of these lines move
    #[arg(long, value_name = "FIRST-LAST", value_parser = lines)]
    pub lines: Option<RangeInclusive<u32>>,
}

fn hours(words: &str) -> Result<f64, String> {
    let read = words.parse().ok().filter(|hours: &f64| (0.01..=1_000.0).contains(hours));
    read.ok_or_else(|| "write the hours as a number from 0.01 to 1000".to_owned())
}

fn lines(words: &str) -> Result<RangeInclusive<u32>, String> {
    let wrong = || "write the lines as 10-25".to_owned();
    let (first, last) = words.split_once('-').ok_or_else(wrong)?;
    let line = |text: &str| text.trim().parse::<u32>().map_err(|_| wrong());
    let (first, last) = (line(first)?, line(last)?);
    if first <= last { Ok(first..=last) } else { Err(wrong()) }
}

fn time(words: &str) -> Result<Micros, String> {
    crate::story::parse::parse_duration(words).map(Micros::from_secs_f64)
}

fn clock(words: &str) -> Result<DateTime, String> {
    DateTime::parse(words).ok_or_else(|| "write date and time as \"2026-11-21 15:01:56\"".to_owned())
}

fn kind_help() -> String {
    let kinds: Vec<_> = Kind::ALL.iter().map(|kind| format!("{} ({})", kind.id(), kind.row().summary)).collect();
    let default = Kind::default().id();
    format!("Kind of machine: {} [default: as set on the machine, else {default}]", kinds.join(", "))
}

fn kind(word: &str) -> Result<Kind, String> {
    Kind::from_id(word).ok_or_else(|| {
        let kinds: Vec<_> = Kind::ALL.iter().map(|kind| kind.id()).collect();
        format!("the kinds are {}", kinds.join(", "))
    })
}

fn axis(word: &str) -> Result<Axis, String> {
    let mut letters = word.chars();
    let axis = letters.next().and_then(Axis::from_letter).filter(|_| letters.next().is_none());
    axis.ok_or_else(|| "the axes are X, Y, Z".to_owned())
}

fn page(word: &str) -> Result<Page, String> {
    Page::from_id(word).ok_or_else(|| {
        let pages: Vec<_> = Page::ALL.iter().map(|page| page.id()).collect();
        format!("the pages are {}", pages.join(", "))
    })
}

fn size(word: &str) -> Result<(u32, u32), String> {
    const LEAST: u32 = 320;
    const MOST: u32 = 7_680;
    let wrong = || format!("write the size as 1024x768, each side from {LEAST} to {MOST}");
    let (width, height) = word.split_once('x').ok_or_else(wrong)?;
    let side = |text: &str| text.parse().ok().filter(|side| (LEAST..=MOST).contains(side)).ok_or_else(wrong);
    Ok((side(width)?, side(height)?))
}

fn param(word: &str) -> Result<(ParamAddress, f64), String> {
    let wrong = || "write a parameter as P270=0 or P16.0=1".to_owned();
    let (at, value) = word.split_once('=').ok_or_else(wrong)?;
    Ok((ParamAddress::parse(at.trim()).ok_or_else(wrong)?, value.trim().parse().map_err(|_| wrong())?))
}

fn variable(word: &str) -> Result<(u16, f64), String> {
    let wrong = || "write a variable as '#500=40.2' or R18=200".to_owned();
    let (name, value) = word.split_once('=').ok_or_else(wrong)?;
    let number = crate::story::parse::variable(name.trim()).ok_or_else(wrong)?;
    let value: f64 = value.trim().parse().map_err(|_| wrong())?;
    if value.is_finite() { Ok((number, value)) } else { Err(wrong()) }
}

/// A size of the screen, percent.
fn zoom(word: &str) -> Result<u16, String> {
    let known = word.trim_end_matches(['%', ' ']).parse().ok().filter(|percent| ZOOMS.contains(percent));
    known.ok_or_else(|| format!("write one of {ZOOMS:?}"))
}

/// A time as people write it, s: `90`, `90s`, `10min`, `2h`; a day at most.
fn seconds_of(written: &str) -> Result<u64, String> {
    let digits = written.trim_end_matches(|sign: char| sign.is_ascii_alphabetic());
    let factor = match &written[digits.len()..] {
        "" | "s" => 1,
        "min" => 60,
        "h" => 3_600,
        other => return Err(format!("'{other}' is no unit: s, min or h")),
    };
    let seconds = digits.parse().ok().and_then(|number: u64| number.checked_mul(factor));
    seconds
        .filter(|seconds| (1..=86_400).contains(seconds))
        .ok_or_else(|| "a whole number with s, min or h: 1s to 24h".to_owned())
}
