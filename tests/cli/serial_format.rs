//! The format of a transmission over RS232: what is sent, and what is read back.

use encoding_rs::GBK;
use kt830::host::serial::SerialError;
use kt830::host::serial::format::{ReadProgress, SerialProgram, SerialReader, encode_transmission};
use kt830::store::ProgramFolder;

fn sheet(name: &str, text: &str) -> SerialProgram {
    SerialProgram { name: name.into(), text: text.as_bytes().to_vec() }
}

fn take(bytes: &[u8], limit: usize) -> Result<SerialReader, SerialError> {
    let mut reader = SerialReader::new(limit);
    for byte in bytes {
        if reader.push(*byte)? == ReadProgress::Done {
            return Ok(reader);
        }
    }
    if reader.is_closing() { Ok(reader) } else { Err(reader.timeout_error()) }
}

fn back(bytes: &[u8], asked: Option<&str>, named: bool) -> Result<Vec<SerialProgram>, SerialError> {
    take(bytes, 10_000)?.into_programs(asked, &ProgramFolder::new(std::path::Path::new("."), named), named)
}

#[test]
fn l9_a_program_stands_between_percents_with_leader_number_and_cr_lf() {
    let out = encode_transmission(&[sheet("O1001.NC", "%\nO77 (JAW)\nG00 X50\n\nM30\n%\n")], 3, false);
    assert_eq!(out.unwrap(), b"\0\0\0%\r\nO1001 (JAW)\r\nG00 X50\r\n\r\nM30\r\n%\r\n\0\0\0");
    let out = encode_transmission(&[sheet("O0005.NC", "M30")], 0, false);
    assert_eq!(out.unwrap(), b"%\r\nO0005\r\nM30\r\n%\r\n");
    let out = encode_transmission(&[sheet("SHAFT.NC", "N0010M02\r\n")], 0, true);
    assert_eq!(out.unwrap(), b"%\r\n<SHAFT>\r\nN0010M02\r\n%\r\n");
    let out = encode_transmission(&[sheet("VGRIND.MPF", "M2"), sheet("l10.spf", "RET")], 0, false);
    assert_eq!(out.unwrap(), b"%_N_VGRIND_MPF\r\nM2\r\n%_N_L10_SPF\r\nRET\r\n%\r\n");
}

#[test]
fn l9_what_goes_out_comes_back() {
    let gbk = GBK.encode("(外圆磨)\r\nM30\r\n").0.into_owned();
    let sheets = [
        SerialProgram { name: "O1001.NC".into(), text: [b"O1001\r\n".as_slice(), &gbk].concat() },
        sheet("O1002.NC", "O1002 (外圆)\r\nG01 X1\r\nM30\r\n"),
        sheet("VGRIND.MPF", "R1=5\r\nM2\r\n"),
    ];
    // One text is GBK, the other UTF-8: each is sent alone, because a file has one encoding.
    for one in &sheets {
        let out = encode_transmission(std::slice::from_ref(one), 8, false).unwrap();
        assert_eq!(back(&out, None, false).unwrap(), std::slice::from_ref(one));
    }
    let both = encode_transmission(&sheets[1..], 8, false).unwrap();
    assert_eq!(back(&both, None, false).unwrap(), &sheets[1..]);
    let shaft = [sheet("SHAFT.NC", "N0010M02\r\n")];
    assert_eq!(back(&encode_transmission(&shaft, 0, true).unwrap(), None, true).unwrap(), shaft);
}

#[test]
fn l9_several_programs_and_heads_of_other_controls_are_told_apart() {
    let found = back(b"%\nO1001(A)\nM30\nO1002\nM30\n%\n", None, false).unwrap();
    let names: Vec<_> = found.iter().map(|sheet| sheet.name.as_str()).collect();
    assert_eq!(names, ["O1001.NC", "O1002.NC"]);
    assert_eq!(back(b"%\r(TITLE)\r:0007\rM30\r%", None, false).unwrap()[0].text, b"(TITLE)\r\n:0007\r\nM30\r\n");
    assert_eq!(back(b"%\n<O0012>\nM30\n%\n", None, false).unwrap()[0].name, "O0012.NC");
    assert_eq!(back(b"%O0013\nM30\n%\n", None, false).unwrap()[0].name, "O0013.NC");
    // LF CR CR is the line end of old tape punches; the given name is used.
    let asked = back(b"%\n\r\rG00 X1\n\r\rM30\n\r\r%\n\r\r", Some("O0099.NC"), false).unwrap();
    assert_eq!((asked[0].name.as_str(), asked[0].text.as_slice()), ("O0099.NC", b"G00 X1\r\nM30\r\n".as_slice()));
}

#[test]
fn l9_a_name_that_leads_out_of_the_folder_is_none() {
    for bytes in [b"%\n<../../X>\nM30\n%\n".as_slice(), b"%\n</etc/passwd>\nM30\n%\n", b"%_N_.._MPF\nM2\n%\n"] {
        for named in [false, true] {
            assert!(
                matches!(back(bytes, None, named), Err(SerialError::BadFormat(_))),
                "{}",
                String::from_utf8_lossy(bytes)
            );
        }
    }
    assert!(matches!(back(b"%\nM30\n%\n", None, false), Err(SerialError::BadFormat(_))), "no name at all");
    assert!(matches!(back(b"%\nO1\nM30\nO1\nM30\n%\n", None, false), Err(SerialError::BadFormat(_))), "twice");
    assert!(matches!(back(b"%\n\n%\n", None, false), Err(SerialError::BadFormat(_))), "nothing");
}

#[test]
fn l9_noise_parity_and_length_are_told_with_their_line() {
    assert_eq!(take(b"%\nO1\nG0\x00X1\n%\n", 99).unwrap_err(), SerialError::Noise(3), "a broken frame reads as NUL");
    assert!(
        matches!(back(b"%O1 \xFF\xFF\nG0\nM30\n%\n", None, false), Err(SerialError::Noise(1))),
        "garbage in the header"
    );
    assert_eq!(take(b"%\nO1\nG0\x05", 99).unwrap_err(), SerialError::Noise(3));
    assert!(matches!(back(b"%\nO1\nG0\xFF\xFF\nM30\n%\n", None, false), Err(SerialError::Noise(_))));
    // 7 bits, even parity: `%` is 0xA5, LF 0x0A.
    let even = |byte: u8| if byte.count_ones() % 2 == 1 { byte | 0x80 } else { byte };
    let seven: Vec<u8> = b"%\nO1001\nG00 X100\nM30\n%\n".iter().map(|byte| even(*byte)).collect();
    assert_eq!(take(&seven, 99).unwrap_err(), SerialError::Parity);
    assert_eq!(take(&[0xFE, 0x03, 0x81], 99).unwrap_err(), SerialError::Noise(0));
    assert_eq!(take(&[0xB1; 5_000], 9_999).unwrap_err(), SerialError::Parity);
    assert!(matches!(take(b"O1001\nM30\n", 99), Err(SerialError::BadFormat(_))), "no percent at the beginning");
    assert_eq!(take(b"%\n0123456789", 9).unwrap_err(), SerialError::TooLong(9));
    assert_eq!(
        take(b"%\nO1\nM30\n", 99).unwrap_err(),
        SerialError::NoData(Some(4)),
        "without its end nothing is stored"
    );
    assert!(matches!(take(b"%\nO1\nG0 (50%)\nM30\n%\n", 99), Err(SerialError::BadFormat(_))));
    assert!(matches!(
        encode_transmission(&[sheet("O0001.NC", "G0 (50%)")], 0, false),
        Err(SerialError::NotSendable(_))
    ));
    assert!(matches!(
        encode_transmission(&[sheet("O0001.NC", "G0\x13X1")], 0, false),
        Err(SerialError::NotSendable(_))
    ));
}
