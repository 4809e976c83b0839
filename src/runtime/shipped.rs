//! Programs, page texts and pictures that the control brings along, written once into folders that are made new.
//! Source: spec K7.3, T1.

/// A file: its place below the data directory, and what is in it.
pub(super) type Shipped = (&'static str, &'static [u8]);

macro_rules! shipped {
    (pages $($page:literal)*; subprograms $($sub:literal)*) => {
        /// All of them.
        pub(super) const SHIPPED: &[Shipped] = &[
            $(
                (concat!("programs/O1", $page, ".NC"), include_bytes!(concat!("../../programs/O1", $page, ".NC"))),
                (concat!("screens/C0", $page, ".TXT"), include_bytes!(concat!("../../screens/C0", $page, ".TXT"))),
                (concat!("screens/B0", $page, ".BMP"), include_bytes!(concat!("../../screens/B0", $page, ".BMP"))),
            )*
            $((concat!("programs/O", $sub, ".NC"), include_bytes!(concat!("../../programs/O", $sub, ".NC"))),)*
            ("screens/B0100.BMP", include_bytes!("../../screens/B0100.BMP")),
        ];
    };
}

shipped! {
    pages "001" "002" "003" "004" "005" "006" "007" "008" "009" "010" "011" "012" "013" "014";
    subprograms "9000" "9001" "9010" "9011" "9012" "9020"
}

/// The programs of the lathe, by name.
pub(super) const SHIPPED_BY_NAME: &[Shipped] = &[
    ("SHAFT.NC", include_bytes!("../../programs/lathe/SHAFT.NC")),
    ("TEST.NC", include_bytes!("../../programs/lathe/TEST.NC")),
];
