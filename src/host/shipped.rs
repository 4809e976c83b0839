//! Programs, page texts and pictures shipped with the control. They are written once into new folders.
//! Source: spec K7.3, T1.

/// A shipped file: path below the data directory and content.
pub(super) type Shipped = (&'static str, &'static [u8]);

macro_rules! shipped {
    (pages $($page:literal)*; subprograms $($sub:literal)*; sheets $($sheet:literal)*) => {
        /// The shipped files, except the programs in the subfolder of a kind.
        pub(super) const SHIPPED: &[Shipped] = &[
            $(
                (concat!("programs/O1", $page, ".NC"), include_bytes!(concat!("../../programs/O1", $page, ".NC"))),
                (concat!("screens/C0", $page, ".TXT"), include_bytes!(concat!("../../screens/C0", $page, ".TXT"))),
                (concat!("screens/C0", $page, ".EN.TXT"), include_bytes!(concat!("../../screens/C0", $page, ".EN.TXT"))),
                (concat!("screens/B0", $page, ".BMP"), include_bytes!(concat!("../../screens/B0", $page, ".BMP"))),
                (concat!("screens/D0", $page, ".RON"), include_bytes!(concat!("../../screens/D0", $page, ".RON"))),
            )*
            $((concat!("programs/O", $sub, ".NC"), include_bytes!(concat!("../../programs/O", $sub, ".NC"))),)*
            $(
                (concat!("screens/C0", $sheet, ".TXT"), include_bytes!(concat!("../../screens/C0", $sheet, ".TXT"))),
                (
                    concat!("screens/C0", $sheet, ".EN.TXT"),
                    include_bytes!(concat!("../../screens/C0", $sheet, ".EN.TXT")),
                ),
                (concat!("screens/B0", $sheet, ".BMP"), include_bytes!(concat!("../../screens/B0", $sheet, ".BMP"))),
                (concat!("screens/D0", $sheet, ".RON"), include_bytes!(concat!("../../screens/D0", $sheet, ".RON"))),
            )*
            ("screens/B0100.BMP", include_bytes!("../../screens/B0100.BMP")),
        ];
    };
}

/// The shipped picture of this name.
pub(super) fn shipped_picture(name: &str) -> Option<&'static [u8]> {
    SHIPPED.iter().find(|(path, _)| path.strip_prefix("screens/") == Some(name)).map(|(_, bytes)| *bytes)
}

shipped! {
    pages "001" "002" "003" "004" "005" "006" "007" "008" "009" "010" "011" "012" "013" "014" "015" "016" "017" "018" "019"
        "020";
    subprograms "9000" "9001" "9010" "9011" "9012" "9013" "9014" "9015" "9016" "9017" "9018" "9020" "9071" "9073"
        "9075" "9076" "9077" "9078" "9079";
    sheets "801" "802" "803"
}
