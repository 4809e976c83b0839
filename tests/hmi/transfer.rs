//! Transfer to and from a medium with the real core and folders behind it, and pictures of the screen.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::live_screen::Bench;
use crate::sample::busy;
use crate::screen::{Screen, open};
use egui::{Color32, ColorImage};
use egui_kittest::kittest::Queryable;
use kt830::defs::kind::Dialect;
use kt830::defs::page::Page;
use kt830::defs::text::{Lang, LocalizedText};
use kt830::host::folders::Folders;
use kt830::link::Command;
use kt830::link::files::{Completion, FileAnswer, FileRequest, Refusal, Requester, Ticket};
use kt830::link::page_command::{PageCommand, PasswordScope, Secret, StorageAnswer};
use tempfile::TempDir;

/// A control with folders of its own and a medium.
struct Shop {
    folder: TempDir,
    bench: Bench,
}

impl Shop {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["programs", "screens", "usb"] {
            fs::create_dir(path(name)).unwrap();
        }
        for number in [1_001, 1_002] {
            fs::copy(
                crate::stories::folders().programs.join(format!("O{number}.NC")),
                path("programs").join(format!("O{number}.NC")),
            )
            .unwrap();
        }
        for name in ["C0001.TXT", "B0001.BMP"] {
            fs::copy(crate::stories::folders().screens.join(name), path("screens").join(name)).unwrap();
        }
        let mut rig = crate::stories::rig_in(Folders {
            programs: path("programs"),
            screens: path("screens"),
            by_name: false,
            dialect: Dialect::LatheA,
        });
        rig.set_drives(Some(path("prints")), Some(path("usb")));
        let mut bench = Bench::new(rig, Page::Transfer);
        bench.turn();
        Self { folder, bench }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn usb(&self, name: &str) -> PathBuf {
        self.path("usb").join(name)
    }

    fn out(&mut self) {
        self.bench.touch("本机 → U 盘 transfer-out");
    }

    fn bring(&mut self) {
        self.bench.touch("U 盘 → 本机 transfer-in");
    }

    fn bring_serial(&mut self) {
        self.bench.touch("RS232 → 本机 transfer-in");
    }

    fn refusal(&self) -> String {
        self.bench.screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why).unwrap_or_default()
    }

    fn password(&mut self, digits: &str) {
        assert!(self.bench.asks_password());
        self.bench.write(digits);
        self.bench.press(egui::Key::Enter);
    }

    /// The builder is at the panel.
    fn builder(&mut self) {
        self.bench.rig.send(Command::Page(PageCommand::Unlock(PasswordScope::Builder, Secret::new("830830".into()))));
        self.bench.turn();
    }

    fn same(&self, one: &Path, other: &Path) -> bool {
        fs::read(one).unwrap() == fs::read(other).unwrap()
    }
}

#[test]
fn k7_8_programs_go_both_ways_and_ask_before_they_overwrite() {
    let mut shop = Shop::new();
    shop.bench.touch("O1002.NC file-0");
    shop.out();
    assert!(shop.same(&shop.usb("O1002.NC"), &shop.path("programs/O1002.NC")), "{}", shop.refusal());
    assert!(!shop.usb("O1001.NC").exists(), "one was chosen");
    // Changed on the computer, and brought back: the password, then the question.
    fs::write(shop.usb("O1002.NC"), "O1002 (NEW)\nM30\n").unwrap();
    fs::write(shop.usb("O0077.NC"), "O0077\nM30\n").unwrap();
    shop.bring();
    shop.password("187350");
    assert!(shop.bench.shows("文件已存在且内容不同") && shop.bench.shows("O1002.NC"));
    shop.bench.touch("跳过 question-skip");
    assert!(!shop.same(&shop.usb("O1002.NC"), &shop.path("programs/O1002.NC")));
    assert!(shop.bench.rig.has_program(77), "what does not clash comes in");
    shop.bring();
    shop.bench.touch("覆盖 question-overwrite");
    assert!(shop.same(&shop.usb("O1002.NC"), &shop.path("programs/O1002.NC")));
}

#[test]
fn k7_8_a_file_with_several_programs_is_divided_if_the_operator_wants_it() {
    let mut shop = Shop::new();
    fs::write(shop.usb("ALL-PROG.TXT"), "%\nO0077\nM98 P78\nM30\nO0078\nM99\n%\n").unwrap();
    shop.bring();
    shop.password("187350");
    assert!(shop.bench.shows("文件里有几个程序") && shop.bench.shows("ALL-PROG.TXT: O0077.NC  O0078.NC"));
    shop.bench.touch("取消 question-no");
    assert!(!shop.bench.rig.has_program(77), "nothing is copied");
    shop.bring();
    shop.bench.touch("每个程序一个文件 question-split");
    assert!(shop.path("programs/O0077.NC").exists() && shop.path("programs/O0078.NC").exists(), "{}", shop.refusal());
    assert!(shop.bench.rig.has_program(78));
}

#[test]
fn k7_8_page_files_come_in_only_if_they_are_of_the_form() {
    let mut shop = Shop::new();
    shop.bench.touch("页面文件 set-screens");
    shop.out();
    assert!(shop.usb("C0001.TXT").exists() && shop.usb("B0001.BMP").exists(), "{}", shop.refusal());
    // A header that speaks of 4 GB, and a size that is not 240 054 bytes.
    let mut bmp = fs::read(shop.usb("B0001.BMP")).unwrap();
    bmp[18..26].copy_from_slice(&[0xFF; 8]);
    fs::write(shop.usb("B0003.BMP"), &bmp).unwrap();
    shop.bench.touch("页面文件 set-screens");
    shop.bring();
    assert!(shop.refusal().contains("B0003.BMP"), "{}", shop.refusal());
    assert!(!shop.path("screens/B0003.BMP").exists());
}

#[test]
fn k5_12_a_picture_of_another_form_is_named_and_converted() {
    let mut shop = Shop::new();
    // A red PNG of twice the width: 200 × 100 of it fit, white above and below.
    image::RgbImage::from_pixel(400, 200, image::Rgb([255, 0, 0])).save(shop.usb("B0003.PNG")).unwrap();
    shop.bench.touch("页面文件 set-screens");
    shop.bring();
    assert!(shop.bench.shows("B0003.PNG") && shop.bench.shows("不是 BMP"), "{}", shop.refusal());
    shop.bench.touch("取消 question-no");
    assert!(!shop.path("screens/B0003.BMP").exists());
    shop.bring();
    shop.bench.touch("转换 question-convert");
    let bytes = fs::read(shop.path("screens/B0003.BMP")).unwrap();
    assert_eq!(bytes.len(), 240_054);
    let picture = kt830::host::folders::parse_picture("B0003.BMP", &bytes).unwrap();
    let picture = image::load_from_memory(&picture.0).unwrap().into_rgb8();
    assert_eq!((picture.get_pixel(100, 200).0, picture.get_pixel(100, 10).0), ([255, 0, 0], [255, 255, 255]));
}

#[test]
fn k7_8_parameters_and_macro_values_go_both_ways() {
    let mut shop = Shop::new();
    crate::stories::tell(&mut shop.bench.rig, "param P71 42\nset #600 = 1.25");
    shop.bench.touch("参数 set-params");
    shop.out();
    shop.bench.touch("宏变量 set-variables");
    shop.out();
    crate::stories::tell(&mut shop.bench.rig, "param P71 7\nset #600 = 9");
    shop.bring();
    let variable = |shop: &mut Shop| shop.bench.rig.snapshot().variables[600];
    assert_eq!(variable(&mut shop), Some(1.25), "{}", shop.refusal());
    shop.bench.touch("参数 set-params");
    shop.bring();
    shop.password("830830");
    assert_eq!(shop.bench.param("P71").to_bits(), 42.0_f64.to_bits());
    // One value out of range refuses the whole file.
    let file = shop.usb("KT830-PARAM.RON");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace("\"P71\": 42.0", "\"P71\": 1e9").replace("\"P56\": ", "\"P56\": 7")).unwrap();
    let before = shop.bench.rig.retained().params.clone();
    shop.bring();
    assert!(shop.refusal().contains("P56"), "{}", shop.refusal());
    assert!(shop.bench.rig.retained().params == before);
    // What the file has beside its own set would be ignored: it is named.
    let text = text.replace("frames: {}", "frames: { 0: ((-1.0, 0.0, -2.0)) }");
    assert!(text.contains("-2.0"), "{text}");
    fs::write(&file, text).unwrap();
    shop.bring();
    assert!(shop.refusal().contains("工件坐标系"), "{}", shop.refusal());
    assert!(shop.bench.rig.retained().params == before);
}

#[test]
fn k7_8_everything_is_one_archive_and_comes_back() {
    let mut shop = Shop::new();
    crate::stories::tell(&mut shop.bench.rig, "param P71 42\nset #600 = 1.25");
    let program = fs::read(shop.path("programs/O1001.NC")).unwrap();
    shop.bench.touch("全部备份 set-backup");
    shop.out();
    fs::write(shop.path("programs/O1001.NC"), "M30\n").unwrap();
    fs::remove_file(shop.path("screens/C0001.TXT")).unwrap();
    crate::stories::tell(&mut shop.bench.rig, "param P71 7\nset #600 = 9");
    shop.builder();
    shop.bring();
    assert!(shop.bench.shows("恢复备份？"), "{}", shop.refusal());
    shop.bench.touch("覆盖 question-overwrite");
    assert_eq!(fs::read(shop.path("programs/O1001.NC")).unwrap(), program, "{}", shop.refusal());
    assert!(shop.path("screens/C0001.TXT").exists());
    assert_eq!(shop.bench.rig.snapshot().variables[600], Some(1.25));
    assert_eq!(shop.bench.param("P71").to_bits(), 42.0_f64.to_bits());
}

#[test]
fn k7_8_a_damaged_or_foreign_archive_changes_nothing() {
    let mut shop = Shop::new();
    shop.builder();
    shop.bench.touch("全部备份 set-backup");
    shop.out();
    let name = fs::read_dir(shop.path("usb")).unwrap().next().unwrap().unwrap().file_name().into_string().unwrap();
    let good = fs::read(shop.usb(&name)).unwrap();
    let program = fs::read(shop.path("programs/O1001.NC")).unwrap();
    let mut try_it = |bytes: &[u8], what: &str| {
        fs::write(shop.usb(&name), bytes).unwrap();
        shop.bring();
        shop.bench.touch("覆盖 question-overwrite");
        assert!(shop.refusal().contains("备份"), "{what}: {}", shop.refusal());
        assert_eq!(fs::read(shop.path("programs/O1001.NC")).unwrap(), program, "{what}");
    };
    let mut flipped = good.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    try_it(&flipped, "a flipped bit");
    try_it(&good[..good.len() / 3], "cut off");
    try_it(b"not an archive at all", "no archive");
    // A name that leads out of the folder, and a link.
    let archive = |name: &[u8], link: bool| {
        let mut builder = tar::Builder::new(Vec::new());
        let mut header = tar::Header::new_gnu();
        header.as_old_mut().name[..name.len()].copy_from_slice(name);
        header.set_size(3);
        if link {
            header.set_entry_type(tar::EntryType::Symlink);
            header.set_size(0);
        }
        header.set_cksum();
        builder.append(&header, &b"M30"[..if link { 0 } else { 3 }]).unwrap();
        builder.into_inner().unwrap()
    };
    try_it(&archive(b"programs/../../O1001.NC", false), "a way out");
    try_it(&archive(b"/etc/O1001.NC", false), "an absolute name");
    try_it(&archive(b"programs/O1001.NC", true), "a link");
    // Larger than 512 MiB: it is not even read.
    let giant = fs::File::create(shop.usb(&name)).unwrap();
    giant.set_len(512 * 1024 * 1024 + 1).unwrap();
    shop.bring();
    shop.bench.touch("覆盖 question-overwrite");
    assert!(shop.refusal().contains("最多 536870912"), "{}", shop.refusal());
    assert_eq!(fs::read(shop.path("programs/O1001.NC")).unwrap(), program);
}

#[test]
fn h8_no_medium_and_a_pulled_out_one_are_told() {
    let mut shop = Shop::new();
    fs::remove_dir_all(shop.path("usb")).unwrap();
    shop.bench.rig.send(Command::OpenPage(Page::Position));
    shop.bench.turn();
    shop.bench.rig.send(Command::OpenPage(Page::Transfer));
    (0..4).for_each(|_| shop.bench.turn());
    assert!(shop.bench.shows("没有 U 盘。请插入"));
    shop.out();
    assert!(shop.refusal().contains("U 盘"), "{}", shop.refusal());
}

#[test]
fn k7_8_nothing_comes_in_while_a_program_runs() {
    let mut shop = Shop::new();
    shop.builder();
    shop.bench.touch("宏变量 set-variables");
    shop.out();
    let mut rig = crate::stories::ready_with("G04 P9000\nM30");
    rig.set_drives(None, Some(shop.path("usb")));
    crate::stories::tell(&mut rig, "set #600 = 5\nmode auto\nkey cycle-start\nwait 0.1 s\nexpect state running");
    let mut bench = Bench::new(rig, Page::Transfer);
    bench.turn();
    bench.touch("宏变量 set-variables");
    bench.touch("U 盘 → 本机 transfer-in");
    let why = bench.screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why).unwrap_or_default();
    assert!(why.contains("运行中"), "{why}");
    assert_eq!(bench.rig.snapshot().variables[600], Some(5.0));
}

#[test]
fn k7_8_the_screen_is_kept_as_a_picture() {
    let mut shop = Shop::new();
    let image = ColorImage::filled([40, 30], Color32::from_rgb(1, 2, 3));
    shop.bench.screen.state().hmi.screenshots().lock().unwrap().push(Arc::new(image));
    shop.bench.turn();
    assert!(shop.bench.message().contains("已保存"), "{}", shop.bench.message());
    let file = fs::read_dir(shop.path("usb")).unwrap().next().expect("on the medium").unwrap().path();
    let read = image::open(file).unwrap().to_rgb8();
    assert_eq!((read.dimensions(), read.get_pixel(39, 29).0), ((40, 30), [1, 2, 3]));
    // Without a medium it is kept in the control's own folder.
    fs::remove_dir_all(shop.path("usb")).unwrap();
    let image = ColorImage::filled([4, 3], Color32::from_rgb(1, 2, 3));
    shop.bench.screen.state().hmi.screenshots().lock().unwrap().push(Arc::new(image));
    shop.bench.turn();
    assert_eq!(fs::read_dir(shop.path("prints")).unwrap().count(), 1);
    // P22.1: as BMP.
    crate::stories::tell(&mut shop.bench.rig, "param P22.1 1");
    shop.bench.turn();
    let image = ColorImage::filled([4, 3], Color32::from_rgb(1, 2, 3));
    shop.bench.screen.state().hmi.screenshots().lock().unwrap().push(Arc::new(image));
    shop.bench.turn();
    let files = fs::read_dir(shop.path("prints")).unwrap().map(|file| file.unwrap().path());
    let bmp = files.filter(|path| path.extension().is_some_and(|end| end == "BMP")).collect::<Vec<_>>();
    assert!(bmp.len() == 1 && fs::read(&bmp[0]).unwrap().starts_with(b"BM"), "{bmp:?}");
    assert_eq!(image::open(&bmp[0]).unwrap().to_rgb8().get_pixel(3, 2).0, [1, 2, 3]);
}

#[test]
fn k7_8_a_medium_pulled_out_on_the_way_is_told_and_nothing_is_changed() {
    let mut shop = Shop::new();
    fs::write(shop.usb("O1002.NC"), "O1002 (NEW)\nM30\n").unwrap();
    let before = fs::read(shop.path("programs/O1002.NC")).unwrap();
    shop.bring();
    shop.password("187350");
    assert!(shop.bench.shows("文件已存在且内容不同"));
    fs::remove_dir_all(shop.path("usb")).unwrap();
    shop.bench.touch("覆盖 question-overwrite");
    assert!(shop.refusal().contains("没有 U 盘或已拔出"), "{}", shop.refusal());
    assert_eq!(fs::read(shop.path("programs/O1002.NC")).unwrap(), before);
}

#[test]
fn s1_programs_with_names_are_listed_and_carried_both_ways() {
    let mut shop = Shop::new();
    fs::write(shop.path("programs/VGRIND.MPF"), "R1=5\nM2\n").unwrap();
    fs::write(shop.usb("l10.spf"), "RET\n").unwrap();
    shop.bench.touch("程序 set-programs");
    (0..3).for_each(|_| shop.bench.rig.send(Command::OpenPage(Page::Transfer)));
    shop.bench.turn();
    shop.out();
    assert!(shop.same(&shop.usb("VGRIND.MPF"), &shop.path("programs/VGRIND.MPF")), "{}", shop.refusal());
    shop.bring();
    shop.password("187350");
    assert_eq!(fs::read(shop.path("programs/l10.spf")).unwrap(), b"RET\n", "{}", shop.refusal());
}

#[test]
fn l9_the_lathes_programs_are_listed_and_carried_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for name in ["lathe", "screens", "usb"] {
        fs::create_dir(path(name)).unwrap();
    }
    fs::write(path("lathe/SHAFT.NC"), "N0010M02\n").unwrap();
    fs::write(path("usb/BOLT.NC"), "N0010M02\n").unwrap();
    // No program of a lathe: it is not listed and not taken.
    fs::write(path("usb/..\\EVIL.NC"), "N0010M02\n").unwrap();
    let kind = kt830::defs::kind::Kind::Lathe;
    let mut rig = crate::stories::rig_of(
        kind,
        Folders { programs: path("lathe"), screens: path("screens"), by_name: true, dialect: Dialect::SuperMan },
    );
    rig.set_drives(None, Some(path("usb")));
    let mut bench = Bench::new(rig, Page::Transfer);
    bench.turn();
    assert!(bench.shows("SHAFT.NC") && bench.shows("BOLT.NC") && !bench.shows("EVIL"));
    bench.touch("本机 → U 盘 transfer-out");
    assert_eq!(fs::read(path("usb/SHAFT.NC")).unwrap(), b"N0010M02\n");
    bench.touch("U 盘 → 本机 transfer-in");
    bench.write("187350");
    bench.press(egui::Key::Enter);
    assert_eq!(fs::read(path("lathe/BOLT.NC")).unwrap(), b"N0010M02\n");
    assert_eq!(fs::read_dir(path("lathe")).unwrap().count(), 2);
}

#[cfg(unix)]
#[test]
fn k7_8_links_and_pipes_are_neither_followed_nor_waited_for() {
    use std::os::unix::fs::symlink;
    let mut shop = Shop::new();
    let secret = shop.path("secret");
    fs::write(&secret, "not for carrying").unwrap();
    symlink(&secret, shop.usb("O0077.NC")).unwrap();
    symlink("/dev/zero", shop.usb("O0078.NC")).unwrap();
    fs::create_dir(shop.usb("O0079.NC")).unwrap();
    let pipe = std::process::Command::new("mkfifo").arg(shop.usb("O0081.NC")).status().unwrap();
    assert!(pipe.success());
    shop.bench.touch("程序 set-programs");
    shop.bring();
    shop.password("187350");
    assert!(shop.refusal().contains("没有可复制的文件"), "{}", shop.refusal());
    // A link under the name that a program would get here: what it leads to stays.
    fs::write(shop.usb("O0080.NC"), "O0080\nM30\n").unwrap();
    symlink(&secret, shop.path("programs/O0080.NC")).unwrap();
    shop.bring();
    assert!(shop.refusal().contains("是链接或目录"), "{}", shop.refusal());
    assert_eq!(fs::read_to_string(&secret).unwrap(), "not for carrying");
}

#[test]
fn b1_a_line_of_a_hundred_megabytes_is_carried_opened_and_drawn() {
    let mut shop = Shop::new();
    let mut line = b"O0900 (".to_vec();
    line.resize(100_000_000, b'X');
    fs::write(shop.usb("O0900.NC"), &line).unwrap();
    shop.bench.touch("程序 set-programs");
    shop.bring();
    shop.password("187350");
    assert!(shop.same(&shop.usb("O0900.NC"), &shop.path("programs/O0900.NC")), "{}", shop.refusal());
    assert!(shop.bench.rig.has_program(900));
    shop.bench.rig.send(Command::LoadProgram(900));
    shop.bench.rig.send(Command::OpenPage(Page::Program));
    shop.bench.turn();
    assert!(shop.bench.shows("O0900 (XXX"), "its beginning is shown");
}

#[test]
fn b1_bytes_of_no_encoding_are_carried_as_they_are_and_shown_not_edited() {
    let mut shop = Shop::new();
    fs::write(shop.usb("O0901.NC"), b"O0901\nG00 X1 (\xFF\xFF\x80)\nM30\n").unwrap();
    shop.bench.touch("程序 set-programs");
    shop.bring();
    shop.password("187350");
    assert!(shop.same(&shop.usb("O0901.NC"), &shop.path("programs/O0901.NC")), "{}", shop.refusal());
    shop.bench.rig.send(Command::LoadProgram(901));
    shop.bench.rig.send(Command::OpenPage(Page::Program));
    shop.bench.turn();
    assert!(shop.bench.rig.snapshot().program.has_invalid_bytes && shop.bench.shows("O0901"));
}

#[cfg(unix)]
#[test]
fn l9_the_page_carries_over_rs232() {
    use std::io::{Read, Write};
    let mut shop = Shop::new();
    shop.bench.touch("RS232 set-serial");
    shop.bring_serial();
    assert!(shop.refusal().contains("没有选择端口"), "{}", shop.refusal());
    let (mut other, own) = serialport::TTYPort::pair().unwrap();
    let port = serialport::SerialPort::name(&own).unwrap();
    let kept = fs::File::open(&port).unwrap();
    drop(own);
    shop.bench.rig.set_serial_port(port);
    shop.bench.rig.send(Command::OpenPage(Page::Position));
    shop.bench.turn();
    shop.bench.rig.send(Command::OpenPage(Page::Transfer));
    shop.bench.turn();
    shop.bench.touch("存为 serial-name");
    shop.bench.write("0");
    shop.bring_serial();
    assert!(shop.refusal().contains("1 到 8 位"), "{}", shop.refusal());
    shop.bench.write("77");
    let sender = std::thread::spawn(move || {
        let mut byte = [0];
        serialport::SerialPort::set_timeout(&mut other, std::time::Duration::from_secs(20)).unwrap();
        other.read_exact(&mut byte).unwrap();
        other.write_all(b"%\r\nG00 X1\r\nM30\r\n%\r\n").unwrap();
        (byte, other)
    });
    shop.bring_serial();
    shop.password("187350");
    let (byte, _other) = sender.join().unwrap();
    assert_eq!(byte, [0x11], "XON says that it is ready");
    assert_eq!(fs::read(shop.path("programs/O0077.NC")).unwrap(), b"G00 X1\r\nM30\r\n", "{}", shop.refusal());
    assert!(shop.bench.rig.has_program(77));
    drop(kept);
}

/// A screen on the page of transfers with a medium in it, and the ticket of the copy it has asked for.
fn copying() -> (Screen, Ticket) {
    let mut machine = busy(Page::Transfer);
    Arc::make_mut(&mut machine.files).busy = None;
    let mut screen = open(machine);
    screen.get_by_label("本机 → U 盘 transfer-out").click();
    screen.step();
    screen.step();
    let sent = screen.state_mut().sent.drain(..).find_map(|command| match command {
        Command::Page(PageCommand::File(ticket, FileRequest::Transfer(_))) => Some(ticket),
        _ => None,
    });
    (screen, sent.expect("a copy was asked for"))
}

fn answer(screen: &mut Screen, ticket: Ticket, result: Result<Completion, Refusal>) {
    Arc::make_mut(&mut screen.state_mut().snapshot.files).add_answer(ticket, result);
    screen.step();
    screen.step();
}

#[test]
fn h8_the_transfer_page_hears_its_own_answers_only() {
    let (mut screen, ticket) = copying();
    let shown = |screen: &Screen| screen.state().hmi.refusal(Lang::Zh).map(|(_, why)| why).unwrap_or_default();
    let because = |words: &str| Refusal::Other(LocalizedText::new(words, words));
    // What others have asked for, with the same number and with another one.
    answer(&mut screen, Ticket { requester: Requester::Editor, ..ticket }, Err(Refusal::Password));
    assert!(screen.query_by_label("密码 password").is_none(), "the editor's password is not this page's");
    answer(&mut screen, Ticket { requester: Requester::Leadscrew, ..ticket }, Err(because("甲")));
    answer(&mut screen, Ticket::without_reply(Requester::Transfer), Err(because("乙")));
    assert_eq!(shown(&screen), "");
    answer(&mut screen, ticket, Err(because("丙")));
    assert_eq!(shown(&screen), "丙");
}

#[test]
fn h8_a_refusal_of_another_request_does_not_end_the_work_under_way() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("O1234.NC"), "M30\n").unwrap();
    let screens = crate::stories::folders().screens;
    let mut rig = crate::stories::rig_in(Folders {
        programs: folder.path().to_owned(),
        screens,
        by_name: false,
        dialect: Dialect::LatheA,
    });
    crate::stories::tell(&mut rig, "param P22.5 0\nmode edit\nload O1234");
    let ticket = Ticket { requester: Requester::Directory, number: 1 };
    rig.send(Command::Page(PageCommand::File(ticket, FileRequest::Rename { from: 1_234, to: 1_235 })));
    // In the same tick: the queue of the jobs had no room for something else.
    let other =
        StorageAnswer::File(Ticket { requester: Requester::Screen, number: 1 }, FileAnswer::Refused(Refusal::Conflict));
    rig.send(Command::Page(PageCommand::StorageAnswered(other)));
    (0..3).for_each(|_| rig.step());
    assert_eq!(rig.snapshot().program.number, 1_235, "the current program goes by its new number");
    let answers: Vec<_> = rig.snapshot().files.answers.iter().map(|answer| answer.ticket.requester).collect();
    assert_eq!(answers, [Requester::Screen, Requester::Directory]);
}

/// H9: the English text of a page goes with it: to the medium, back, and into the backup.
#[test]
fn h9_english_texts_are_copied_and_backed_up_as_page_files() {
    let mut shop = Shop::new();
    let name = "screens/C0001.EN.TXT";
    fs::copy(crate::stories::folders().screens.join("C0001.EN.TXT"), shop.path(name)).unwrap();
    let text = fs::read(shop.path(name)).unwrap();
    shop.bench.touch("页面文件 set-screens");
    shop.out();
    assert_eq!(fs::read(shop.usb("C0001.EN.TXT")).unwrap(), text, "{}", shop.refusal());
    shop.bench.touch("全部备份 set-backup");
    shop.out();
    fs::remove_file(shop.path(name)).unwrap();
    shop.builder();
    shop.bring();
    shop.bench.touch("覆盖 question-overwrite");
    assert_eq!(fs::read(shop.path(name)).unwrap(), text, "{}", shop.refusal());
    fs::remove_file(shop.path(name)).unwrap();
    shop.bench.touch("页面文件 set-screens");
    shop.bring();
    assert_eq!(fs::read(shop.path(name)).unwrap(), text, "{}", shop.refusal());
    let screens = shop.bench.rig.snapshot().screens.clone();
    let page = screens.find(1_001).unwrap().text.clone().unwrap();
    assert_eq!(page.title_in(Lang::En), "caliper grinding", "the page is read again");
}
