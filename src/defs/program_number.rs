//! Program names: `O1001`, `L10` and SINUMERIK names such as `VGRIND`. Each name maps to one number, which identifies
//! the program inside the control. Source: spec B1, S1.

/// Least number of digits in the name of an O program.
pub const O_DIGITS: u32 = 4;
/// Most digits of an O number; programs call more than four of them if P418 says so.
pub const O_MAX_DIGITS: u32 = 8;
/// The highest O number.
pub const O_MAX: u32 = o_limit(O_MAX_DIGITS);
/// First number of the subprograms `L0` to `L9999999`.
const L_FIRST: u32 = O_MAX + 1;
/// The highest L number.
pub const L_MAX: u32 = 9_999_999;
/// Numbers from here on are hashes of names.
const NAMED_FIRST: u32 = 1 << 31;

/// The highest O number with this many digits.
#[must_use]
pub const fn o_limit(digits: u32) -> u32 {
    10_u32.pow(digits) - 1
}

/// Whether P23.5 protects a program: the subprograms O9000 to O9999.
#[must_use]
pub const fn is_protected_subprogram(number: u32) -> bool {
    matches!(number, 9_000..=9_999)
}

/// The number of the subprogram `L n`.
#[must_use]
pub const fn from_l(n: u32) -> u32 {
    L_FIRST + n
}

/// Whether a number is the hash of a name; the name itself is only in the file name.
#[must_use]
pub const fn is_named(number: u32) -> bool {
    number >= NAMED_FIRST
}

/// The number that digits in the name of a file spell: four, or up to `most` without a leading zero. So each number has one
/// name.
#[must_use]
pub fn of_digits(digits: &str, most: usize) -> Option<u32> {
    let least = O_DIGITS as usize;
    let is_one_spelling = digits.len() == least || !digits.starts_with('0');
    let fits = (least..=most).contains(&digits.len()) && is_one_spelling;
    digits.parse().ok().filter(|_| fits && digits.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The number of a program name: `O1001`, `L10`, `VGRIND`, in either case.
#[must_use]
pub fn from_name(name: &str) -> u32 {
    let upper = name.to_ascii_uppercase();
    if let Some(n) = upper.strip_prefix('O').and_then(|digits| of_digits(digits, O_MAX_DIGITS as usize)) {
        return n;
    }
    let l = upper.strip_prefix('L').filter(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()));
    if let Some(n) = l.and_then(|digits| digits.parse().ok()).filter(|n| *n <= L_MAX) {
        return from_l(n);
    }
    // FNV-1a, 31 bits: names in a folder of a few dozen programs collide about once in several million folders.
    let hash = upper.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
    NAMED_FIRST | hash
}

/// Whether a word is a valid program name: starts with two letters or `_`, or with L and a digit.
#[must_use]
pub fn is_name(word: &str) -> bool {
    let bytes = word.as_bytes();
    let letter = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'_';
    let l = matches!(bytes.first(), Some(b'L' | b'l')) && bytes.get(1).is_some_and(u8::is_ascii_digit);
    (l || bytes.len() >= 2 && bytes.iter().take(2).all(letter))
        && bytes.iter().all(|byte| letter(byte) || byte.is_ascii_digit())
}

/// The name of a number: `O1001`, `L10`; `MPF` for a named program.
#[must_use]
pub fn name_of(number: u32) -> String {
    match number {
        NAMED_FIRST.. => "MPF".to_owned(),
        L_FIRST.. => format!("L{}", number - L_FIRST),
        _ => format!("O{number:04}"),
    }
}

/// Whether a number is that of an O program: 1 to 99 999 999.
#[must_use]
pub const fn is_o_number(number: u32) -> bool {
    0 < number && number <= O_MAX
}

/// Whether a number belongs to an L subprogram such as `L10`.
#[must_use]
pub const fn is_l_number(number: u32) -> bool {
    number >= L_FIRST && number <= from_l(L_MAX)
}

/// A file name without folder and extension.
#[must_use]
pub fn stem(file: &str) -> &str {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}
